# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The lobe against what is known of GGX, the table against a new fit."""

import math

import numpy as np
import pytest

from reflest_core.brdf.ggx import ALPHA_RATIO, RATIO_KNOTS, ggx_alpha, ggx_lobe
from reflest_core.brdf.ggx_fit import fit_ggx_alpha
from reflest_core.brdf.parameters import WardVariant

UP = np.array([0.0, 0.0, 1.0])


def test_the_peak_is_that_of_the_definition():
    # D(0) = 1 / (pi alpha^2) and V = 1/4 where both directions are the normal.
    assert ggx_lobe(0.3, UP, UP) == pytest.approx(1 / (4 * math.pi * 0.3**2))


def test_nothing_is_reflected_below_the_surface():
    below = np.array([0.6, 0.0, -0.8])
    assert ggx_lobe(0.3, below, UP) == 0
    assert ggx_lobe(0.3, UP, below) == 0


def test_a_narrow_lobe_reflects_all_light():
    # Directions of incidence around a camera at 40 degrees, by midpoints over the hemisphere.
    camera = np.array([math.sin(0.7), 0.0, math.cos(0.7)])
    polar = (np.arange(900) + 0.5) * (math.pi / 2) / 900
    azimuth = (np.arange(1800) + 0.5) * (2 * math.pi) / 1800
    polar, azimuth = np.meshgrid(polar, azimuth, indexing="ij")
    light = np.stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1
    )
    solid_angle = np.sin(polar) * (math.pi / 2 / 900) * (2 * math.pi / 1800)
    albedo = np.sum(ggx_lobe(0.05, light, camera) * np.cos(polar) * solid_angle)
    assert albedo == pytest.approx(1.0, abs=0.01)


def test_exchanging_light_and_camera_changes_nothing():
    light, camera = np.array([0.6, 0.0, 0.8]), np.array([0.0, -0.28, 0.96])
    assert ggx_lobe(0.2, light, camera) == pytest.approx(float(ggx_lobe(0.2, camera, light)))


@pytest.mark.parametrize("variant", WardVariant)
def test_the_table_is_what_the_fit_gives(variant):
    for knot, ratio in zip(RATIO_KNOTS, ALPHA_RATIO[variant], strict=True):
        alpha = max(knot, 0.001)
        assert fit_ggx_alpha(alpha, variant).alpha / alpha == pytest.approx(ratio, abs=2e-4)


@pytest.mark.parametrize("variant", WardVariant)
@pytest.mark.parametrize("alpha", [0.013, 0.05, 0.15, 0.25, 0.45, 0.75, 0.95])
def test_between_knots_the_width_is_the_fitted_one(alpha, variant):
    assert ggx_alpha(alpha, variant) == pytest.approx(
        fit_ggx_alpha(alpha, variant).alpha, rel=0.005
    )


@pytest.mark.parametrize("variant", WardVariant)
def test_glossy_lobes_differ_by_a_fifth(variant):
    # Published in docs/export.md: the shapes differ, so no width brings this to 0.
    assert fit_ggx_alpha(0.1, variant).residual == pytest.approx(0.205, abs=0.005)


def test_no_other_width_is_nearer():
    from reflest_core.brdf.ward import specular

    fitted = ggx_alpha(0.1, WardVariant.WARD_1992)
    slopes = np.linspace(0, 0.6, 4001)
    half = np.stack([slopes, np.zeros_like(slopes), np.ones_like(slopes)], axis=-1)
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    cosine = half[:, 2]
    # d omega = sin theta d theta, d theta = cos^2 theta d tan theta.
    weights = cosine**2 * slopes * cosine**3
    ward = specular(np.array(1.0), np.array(0.1), half, half)

    def difference(alpha):
        return float(np.sum(weights * (ggx_lobe(alpha, half, half) - ward) ** 2))

    assert difference(fitted) < difference(fitted * 1.03)
    assert difference(fitted) < difference(fitted / 1.03)


def test_rough_materials_stay_in_the_range_of_the_formats():
    assert ggx_alpha(5.0, WardVariant.WARD_1992) == 1.0
