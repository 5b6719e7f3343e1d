# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The albedo by sampling half vectors, against a plain sum over the hemisphere."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from reflest_core.brdf.albedo_comparison import ALPHAS, ANGLES, ggx_albedo, main
from reflest_core.brdf.ggx import ggx_alpha, ggx_lobe
from reflest_core.brdf.parameters import WardVariant
from reflest_core.brdf.ward import specular


def summed_albedo(alpha, theta_o, f0, f90):
    camera = np.array([math.sin(theta_o), 0.0, math.cos(theta_o)])
    polar = (np.arange(600) + 0.5) * (math.pi / 2) / 600
    azimuth = (np.arange(1200) + 0.5) * (2 * math.pi) / 1200
    polar, azimuth = np.meshgrid(polar, azimuth, indexing="ij")
    light = np.stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1
    )
    half_dot_o = np.linalg.norm(light + camera, axis=-1) / 2
    fresnel = f0 + (f90 - f0) * (1 - half_dot_o) ** 5
    solid_angle = np.sin(polar) * (math.pi / 2 / 600) * (2 * math.pi / 1200)
    return np.sum(ggx_lobe(alpha, light, camera) * fresnel * np.cos(polar) * solid_angle)


def summed_ward(alpha, theta_o, variant):
    """A plain sum over half vectors, whose grid is fine where the lobe is."""
    camera = np.array([math.sin(theta_o), 0.0, math.cos(theta_o)])
    tangents = np.concatenate([[0.0], alpha * np.geomspace(1e-3, 60, 800)])
    polar = np.arctan(tangents)
    middle = (polar[1:] + polar[:-1]) / 2
    azimuth = (np.arange(720) + 0.5) * (2 * math.pi) / 720
    theta_h, phi = np.meshgrid(middle, azimuth, indexing="ij")
    half = np.stack(
        [np.sin(theta_h) * np.cos(phi), np.sin(theta_h) * np.sin(phi), np.cos(theta_h)], axis=-1
    )
    half_dot_o = half @ camera
    light = 2 * half_dot_o[..., None] * half - camera
    solid_angle = np.sin(theta_h) * np.diff(polar)[:, None] * (2 * math.pi / 720)
    lobe = specular(
        np.array(1.0), np.array(alpha), light, np.broadcast_to(camera, light.shape), variant
    )
    received = np.clip(light[..., 2], 0, None) * 4 * np.clip(half_dot_o, 0, None)
    return float(np.sum(lobe * received * solid_angle))


@pytest.mark.parametrize("theta", [0.0, 0.7, 1.2])
@pytest.mark.parametrize(("f0", "f90"), [(1.0, 1.0), (0.1, 1.0)])
def test_both_ways_agree(theta, f0, f90):
    assert ggx_albedo(0.3, theta, f0, f90) == pytest.approx(
        summed_albedo(0.3, theta, f0, f90), rel=0.005
    )


def test_a_mirror_reflects_all():
    assert ggx_albedo(0.001, 0.5) == pytest.approx(1.0, abs=1e-4)


def test_the_printed_table_holds_the_albedos_of_both_wards_and_of_the_exported_lobe(capsys):
    main()
    header, *lines = capsys.readouterr().out.splitlines()
    assert header.split()[:5] == ["alpha", "angle", *(v.value for v in WardVariant), "gltf"]
    printed = [tuple(map(float, line.split())) for line in lines]
    assert [row[:2] for row in printed] == [(alpha, angle) for alpha in ALPHAS for angle in ANGLES]
    for alpha, angle, ward, bounded, gltf, usd in printed:
        theta = math.radians(angle)
        fitted = ggx_alpha(alpha, WardVariant.WARD_1992)
        assert ward == pytest.approx(summed_ward(alpha, theta, WardVariant.WARD_1992), abs=0.004)
        assert bounded == pytest.approx(
            summed_ward(alpha, theta, WardVariant.BOUNDED_2010), abs=0.004
        )
        assert gltf == pytest.approx(ggx_albedo(fitted, theta), abs=6e-4)
        assert usd == pytest.approx(ggx_albedo(fitted, theta, 0.1) / 0.1, abs=6e-4)


def test_the_documentation_shows_the_printed_table(capsys):
    main()
    printed = [tuple(map(float, line.split())) for line in capsys.readouterr().out.splitlines()[1:]]
    page = (Path(__file__).parents[3] / "docs" / "export.md").read_text()
    found = re.findall(r"^\| (0\.\d+) \| (\d+) degrees \|(.*)\|$", page, re.MULTILINE)
    shown = [tuple(map(float, (alpha, angle, *row.split("|")))) for alpha, angle, row in found]
    assert len(shown) == 9
    assert set(shown) <= set(printed)
