# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Ward's BRDF: hand-computed values, reciprocity, agreement of numpy and torch, gradients."""

import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.brdf.parameters import WardVariant
from reflest_core.brdf.ward import evaluate, specular

VARIANTS = list(WardVariant)
RHO_D = np.array([0.2, 0.4, 0.1])


def direction(theta, phi):
    return np.array(
        [math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)]
    )


angles = st.tuples(st.floats(0.01, 1.5), st.floats(0, 2 * math.pi))


@pytest.mark.parametrize("variant", VARIANTS)
def test_at_normal_incidence_the_lobe_peaks_at_rho_s_over_4_pi_alpha_squared(variant):
    up = direction(0, 0)
    value = evaluate(RHO_D, np.array(0.3), np.array(0.2), up, up, variant)
    np.testing.assert_allclose(value, RHO_D / math.pi + 0.3 / (4 * math.pi * 0.04), rtol=1e-12)


def test_eq_1_off_the_normal():
    # theta_i = 30, theta_o = 60 degrees in one plane on opposite sides: theta_h = 15 degrees.
    omega_i, omega_o = direction(math.radians(30), 0), direction(math.radians(60), math.pi)
    lobe = math.exp(-(math.tan(math.radians(15)) ** 2) / 0.3**2) / (4 * math.pi * 0.3**2)
    expected = 0.5 * lobe / math.sqrt(math.cos(math.radians(30)) * math.cos(math.radians(60)))
    assert specular(np.array(0.5), np.array(0.3), omega_i, omega_o) == pytest.approx(expected)


def test_bounded_variant_off_the_normal():
    omega_i, omega_o = direction(math.radians(30), 0), direction(math.radians(60), math.pi)
    lobe = math.exp(-(math.tan(math.radians(15)) ** 2) / 0.3**2) / (4 * math.pi * 0.3**2)
    l_dot_h = math.cos(math.radians(45))
    expected = 0.5 * lobe / (l_dot_h**2 * math.cos(math.radians(15)) ** 4)
    value = specular(np.array(0.5), np.array(0.3), omega_i, omega_o, WardVariant.BOUNDED_2010)
    assert value == pytest.approx(expected)


@pytest.mark.parametrize("variant", VARIANTS)
@given(incoming=angles, outgoing=angles, alpha=st.floats(0.01, 1))
def test_reciprocal_and_never_negative(variant, incoming, outgoing, alpha):
    i, o, a = direction(*incoming), direction(*outgoing), np.array(alpha)
    forth = specular(np.array(0.5), a, i, o, variant)
    assert forth >= 0
    np.testing.assert_allclose(forth, specular(np.array(0.5), a, o, i, variant), rtol=1e-9)


@pytest.mark.parametrize("variant", VARIANTS)
def test_nothing_is_reflected_below_the_surface(variant):
    up, below = direction(0.3, 0), direction(2.0, 1)
    for pair in ((up, below), (below, up), (below, below)):
        value = evaluate(RHO_D, np.array(0.3), np.array(0.2), *pair, variant)
        np.testing.assert_array_equal(value, 0)


@pytest.mark.parametrize("variant", VARIANTS)
def test_torch_gives_what_numpy_gives_and_its_gradient_is_right(variant):
    omega_i = np.stack([direction(0.3, 0.2), direction(1.0, 2.0)])
    omega_o = np.stack([direction(0.5, 3.0), direction(0.2, 1.0)])
    rho_s, alpha = np.array([0.1, 0.3]), np.array([0.2, 0.4])
    rho_d = np.stack([RHO_D, RHO_D])
    ours = evaluate(rho_d, rho_s, alpha, omega_i, omega_o, variant)
    tensors = [torch.tensor(x, requires_grad=True) for x in (rho_d, rho_s, alpha)]
    fixed = [torch.tensor(omega_i), torch.tensor(omega_o)]
    theirs = evaluate(*tensors, *fixed, variant)
    np.testing.assert_allclose(theirs.detach().numpy(), ours, rtol=1e-12)
    assert torch.autograd.gradcheck(lambda *p: evaluate(*p, *fixed, variant), tensors)
