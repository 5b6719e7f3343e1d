# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The albedo by sampling half vectors, against a plain sum over the hemisphere."""

import math

import numpy as np
import pytest

from reflest_core.brdf.albedo_comparison import ALPHAS, ggx_albedo, main
from reflest_core.brdf.ggx import ggx_lobe


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


@pytest.mark.parametrize("theta", [0.0, 0.7, 1.2])
@pytest.mark.parametrize(("f0", "f90"), [(1.0, 1.0), (0.1, 1.0)])
def test_both_ways_agree(theta, f0, f90):
    assert ggx_albedo(0.3, theta, f0, f90) == pytest.approx(
        summed_albedo(0.3, theta, f0, f90), rel=0.005
    )


def test_a_mirror_reflects_all():
    assert ggx_albedo(0.001, 0.5) == pytest.approx(1.0, abs=1e-4)


def test_the_table_is_printed(capsys):
    main()
    assert len(capsys.readouterr().out.splitlines()) == 1 + 4 * len(ALPHAS)
