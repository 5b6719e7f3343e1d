# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Directional albedo: brute-force integration, and the bound that the 2010 variant adds."""

import math

import numpy as np
import pytest

from reflest_core.brdf.parameters import WardVariant
from reflest_core.brdf.sampling import specular_albedo
from reflest_core.brdf.ward import specular


@pytest.mark.parametrize("variant", list(WardVariant))
@pytest.mark.parametrize("cosine", [0.9, 0.5])
def test_equals_the_integral_over_the_hemisphere(variant, cosine):
    z = (np.arange(600) + 0.5) / 600
    phi = 2 * math.pi * (np.arange(1200) + 0.5) / 1200
    z, phi = np.meshgrid(z, phi, indexing="ij")
    r = np.sqrt(1 - z**2)
    omega_i = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
    omega_o = np.array([math.sqrt(1 - cosine**2), 0, cosine])
    value = specular(np.array(0.5), np.array(0.3), omega_i, omega_o, variant) * z
    integral = value.mean() * 2 * math.pi
    ours = specular_albedo(0.5, 0.3, np.array([cosine]), variant)
    np.testing.assert_allclose(ours, integral, rtol=5e-3)


def test_only_the_bounded_variant_is_bounded():
    cosines = np.array([0.001, 0.01, 0.1, 0.5, 1.0])
    assert (specular_albedo(1.0, 0.5, cosines, WardVariant.BOUNDED_2010) <= 1).all()
    assert specular_albedo(1.0, 0.5, cosines, WardVariant.WARD_1992).max() > 1.5
