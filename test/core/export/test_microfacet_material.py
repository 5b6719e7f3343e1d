# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Known values of the mapping, and that it gives Ward's material back."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.brdf.albedo_comparison import ggx_albedo
from reflest_core.brdf.ggx import RATIO_KNOTS
from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.brdf.sampling import specular_albedo
from reflest_core.export.microfacet_material import (
    MicrofacetMaterial,
    energy_ratio,
    ggx_width,
)

share = st.floats(0, 1)


def test_known_values():
    material = MicrofacetMaterial.from_ward(WardParameters((0.4, 0.08, 0.04), 0.2, 0.1))
    f0 = 0.2 * 0.6595
    assert material.f0 == pytest.approx(f0)
    assert material.base_colour == pytest.approx(tuple(c / (1 - f0) for c in (0.4, 0.08, 0.04)))
    assert material.roughness == pytest.approx(math.sqrt(0.7 * 0.09243), abs=1e-4)


def test_the_bounded_variant_keeps_its_strength():
    ward = WardParameters((0.4, 0.08, 0.04), 0.2, 0.1, WardVariant.BOUNDED_2010)
    assert MicrofacetMaterial.from_ward(ward).f0 == pytest.approx(0.2 * 0.9857)


@pytest.mark.parametrize("variant", WardVariant)
@pytest.mark.parametrize("alpha", RATIO_KNOTS[1::3])
def test_both_lobes_reflect_as_much_light_to_all_sides_together(variant, alpha):
    nodes, weights = np.polynomial.legendre.leggauss(12)
    cosines = 0.5 * (nodes + 1.0)
    ward = np.sum(weights * cosines * specular_albedo(1.0, alpha, cosines, variant))
    width = ggx_width(alpha, variant)
    ggx = sum(
        weight * cosine * ggx_albedo(width, math.acos(cosine))
        for weight, cosine in zip(weights, cosines, strict=True)
    )
    assert energy_ratio(alpha, variant) * ggx == pytest.approx(ward, rel=5e-3)


@given(colour=st.tuples(share, share, share), strength=share, alpha=st.floats(0.001, 2))
def test_base_and_facets_add_up_to_the_diffuse_albedo(colour, strength, alpha):
    rho_d = tuple((1 - strength) * channel for channel in colour)
    ward = WardParameters(rho_d, strength, alpha, WardVariant.BOUNDED_2010)
    material = MicrofacetMaterial.from_ward(ward)
    assert all(0 <= channel <= 1 for channel in material.base_colour)
    assert 0 < material.roughness <= 1
    back = np.array(material.base_colour) * (1 - material.f0)
    limit = 1 - material.f0
    np.testing.assert_allclose(back, np.minimum(rho_d, limit), atol=1e-12)


def test_a_mirror_has_no_base():
    ward = WardParameters((0.0, 0.0, 0.0), 1.0, 1e-9, WardVariant.BOUNDED_2010)
    material = MicrofacetMaterial.from_ward(ward)
    assert material.base_colour == (0.0, 0.0, 0.0)
    assert material.f0 == pytest.approx(1.0)
