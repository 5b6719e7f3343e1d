# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Known values of the mapping, and that it gives Ward's material back."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.export.microfacet_material import MicrofacetMaterial

share = st.floats(0, 1)


def test_known_values():
    material = MicrofacetMaterial.from_ward(WardParameters((0.4, 0.08, 0.04), 0.2, 0.1))
    assert material.base_colour == pytest.approx((0.5, 0.1, 0.05))
    assert material.f0 == pytest.approx(0.2)
    assert material.roughness == pytest.approx(math.sqrt(0.09243), abs=1e-4)


@given(colour=st.tuples(share, share, share), strength=share, alpha=st.floats(0.001, 2))
def test_base_and_facets_add_up_to_the_diffuse_albedo(colour, strength, alpha):
    rho_d = tuple((1 - strength) * channel for channel in colour)
    ward = WardParameters(rho_d, strength, alpha, WardVariant.BOUNDED_2010)
    material = MicrofacetMaterial.from_ward(ward)
    assert all(0 <= channel <= 1 for channel in material.base_colour)
    assert 0 < material.roughness <= 1
    back = np.array(material.base_colour) * (1 - material.f0)
    np.testing.assert_allclose(back, rho_d, atol=1e-12)


def test_a_mirror_has_no_base():
    material = MicrofacetMaterial.from_ward(WardParameters((0.0, 0.0, 0.0), 1.0, 0.01))
    assert material.base_colour == (0.0, 0.0, 0.0)
    assert material.f0 == 1.0
