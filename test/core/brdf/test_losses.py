# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""E_d and E_c: hand-computed values, an independent integral, gradients."""

import math

import numpy as np
import pytest
import torch

from reflest_core.brdf.half_angle import HalfAngleQuadrature
from reflest_core.brdf.losses import colour_constancy, cube_root, parameter_distance
from reflest_core.brdf.parameters import WardVariant
from reflest_core.brdf.sampling import specular_albedo

QUADRATURE = HalfAngleQuadrature.make(96, 24, 24, dtype=torch.float64)


def ward(*rows):
    return torch.tensor(rows, dtype=torch.float64)


def test_parameter_distance_weighs_gloss():
    estimate, truth = ward([1, 2, 3, 4, 5]), ward([0, 0, 0, 0, 0])
    assert parameter_distance(estimate, truth).item() == 55
    assert parameter_distance(estimate, truth, gloss_weight=0.5).item() == 14 + 41 / 2


def test_cube_root_of_two_diffuse_surfaces():
    # |difference| / pi over both hemispheres with one cosine: 0.3 / pi * pi * 2 pi.
    loss = cube_root(ward([0.5, 0.5, 0.5, 0, 0.1]), ward([0.2, 0.2, 0.2, 0, 0.1]), QUADRATURE)
    assert loss.item() == pytest.approx((0.3 * 2 * math.pi) ** (1 / 3), rel=2e-3)


@pytest.mark.parametrize("alpha", [0.005, 0.05, 0.3])
def test_cube_root_of_a_lobe_is_its_mean_albedo(alpha):
    variant = WardVariant.BOUNDED_2010
    lobe, nothing = ward([0, 0, 0, 0.4, alpha]), ward([0, 0, 0, 0, alpha])
    cosines = (np.arange(400) + 0.5) / 400
    integral = specular_albedo(0.4, alpha, cosines, variant).mean() * 2 * math.pi
    loss = cube_root(lobe, nothing, QUADRATURE, variant)
    assert loss.item() == pytest.approx(integral ** (1 / 3), rel=5e-3)


def test_cube_root_has_a_gradient_and_is_almost_nothing_for_equals():
    truth = ward([0.2, 0.3, 0.4, 0.1, 0.2])
    estimate = (truth + 0.05).requires_grad_()
    assert torch.autograd.gradcheck(lambda e: cube_root(e, truth, QUADRATURE), (estimate,))
    assert cube_root(truth, truth, QUADRATURE).item() < 1.01e-3


def test_colour_constancy_by_hand_and_without_background():
    background = np.array([[255.0, 255.0, 255.0], [np.nan, np.nan, np.nan]])
    foreground = np.array([[127.5, 127.5, 127.5], [10.0, 10.0, 10.0]])
    # (0.3 + 0.1) * 1 - 0.5^2.4, three channels; the second view has no background.
    expected = 3 * (0.4 - 0.5**2.4) ** 2
    value = colour_constancy(np.full(3, 0.3), np.array(0.1), foreground, background)
    assert value == pytest.approx(expected)


def test_colour_constancy_gradient_survives_unknown_backgrounds():
    rho_d = torch.full((1, 3), 0.3, dtype=torch.float64, requires_grad=True)
    rho_s = torch.full((1,), 0.1, dtype=torch.float64, requires_grad=True)
    foreground = torch.full((1, 2, 3), 100.0, dtype=torch.float64)
    background = foreground.clone()
    background[0, 1] = torch.nan
    assert torch.autograd.gradcheck(
        lambda d, s: colour_constancy(d, s, foreground, background), (rho_d, rho_s)
    )
