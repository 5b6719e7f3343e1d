# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Ward <-> Lab/c,d (Eq. 2)."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.brdf.gloss import (
    contrast,
    labcd_to_ward,
    specular_strength,
    to_labcd,
    to_ward,
    ward_to_labcd,
)
from reflest_core.brdf.parameters import WardParameters, WardVariant

unit = st.floats(0, 1)


def test_eq_2_by_hand():
    # rho_d = 0.25: cbrt(0.125 + rho_s) - 0.5 with rho_s = 0.216 - 0.125 is 0.6 - 0.5.
    assert contrast(np.array(0.25), np.array(0.091)) == pytest.approx(0.1)
    assert specular_strength(np.array(0.25), np.array(0.1)) == pytest.approx(0.091)


def test_specular_strength_is_clamped_at_zero():
    assert specular_strength(np.array(0.25), np.array(-0.2)) == 0


@given(st.tuples(unit, unit, unit, unit, st.floats(1e-3, 1)))
def test_round_trip_over_the_gamut(values):
    ward = np.array(values)
    np.testing.assert_allclose(labcd_to_ward(ward_to_labcd(ward)), ward, atol=1e-5)


def test_round_trip_of_the_data_classes_keeps_the_variant():
    ward = WardParameters((0.3, 0.2, 0.1), 0.05, 0.1, WardVariant.BOUNDED_2010)
    back = to_ward(to_labcd(ward), ward.variant)
    assert back.variant is WardVariant.BOUNDED_2010
    np.testing.assert_allclose([*back.rho_d, back.rho_s, back.alpha], [0.3, 0.2, 0.1, 0.05, 0.1])
    assert to_labcd(ward).d == pytest.approx(0.9)


def test_gradient():
    ward = torch.tensor([[0.3, 0.2, 0.1, 0.05, 0.1]], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(ward_to_labcd, (ward,))
    labcd = ward_to_labcd(ward).detach().requires_grad_()
    assert torch.autograd.gradcheck(labcd_to_ward, (labcd,))
    nothing = torch.zeros(1, 5, dtype=torch.float64, requires_grad=True)
    ward_to_labcd(nothing).sum().backward()
    assert torch.isfinite(nothing.grad).all()
