# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Gloss of a material by all of its signs: physical whatever they are, and in their direction."""

import itertools
import math

import numpy as np
import pytest

from reflest_core.inference.gloss.view_changes import ViewChanges
from reflest_core.inference.material_gloss import ALPHAS, material_gloss


def changes(near=1e-4, far=3e-4, kurtosis=10.0, noise=1e-5):
    square = 0.5 * (near + far)
    return ViewChanges(near, far, math.sqrt(far), square, kurtosis * square**2, noise, 1000)


def gloss(found=None, alpha=0.1, rho_s=0.05, joint=0.05, irradiance=0.5):
    network = np.array([0.2, 0.2, 0.2, rho_s, alpha])
    return material_gloss(found or changes(), network, joint, irradiance)


def test_blurred_reflections_and_few_peaks_are_rough():
    assert gloss(changes(near=3e-5)).alpha > gloss().alpha > gloss(changes(near=3e-4)).alpha
    assert gloss(changes(kurtosis=3.0)).alpha > gloss(changes(kurtosis=100.0)).alpha


def test_every_sign_of_strength_counts():
    usual = gloss().rho_s
    assert gloss(rho_s=0.2).rho_s > usual
    assert gloss(joint=0.2).rho_s > usual
    assert gloss(irradiance=0.1).rho_s > usual


def test_usual_signs_give_usual_gloss():
    found = gloss()
    assert 0.02 < found.rho_s < 0.12
    assert 0.05 < found.alpha < 0.25


@pytest.mark.parametrize("far", [1e-12, 1e-3, 1e3])
def test_extreme_signs_give_physical_gloss(far):
    for near, kurtosis, alpha, rho_s in itertools.product(
        (1e-12, 1e3), (1.0, 1e6), (-1.0, 0.0, 5.0), (-1.0, 0.0, 7.0)
    ):
        found = gloss(changes(near, far, kurtosis), alpha, rho_s, rho_s, 0.0)
        assert ALPHAS[0] <= found.alpha <= ALPHAS[1]
        assert 0.0 <= found.rho_s <= 1.0
        assert 0.0 < found.alpha_stddev < 1.0
        assert 0.0 < found.rho_s_stddev <= 1.0
