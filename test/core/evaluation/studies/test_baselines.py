# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Baselines give the known answer on scenes where there is one."""

import dataclasses

import numpy as np
import pytest
import torch

from reflest_core.brdf import srgb
from reflest_core.evaluation.studies.baselines import guess_mean, lambertian
from reflest_core.evaluation.studies.single_image import (
    Effort,
    Prior,
    _Problem,
    _ward,
    fullest_view,
)
from reflest_core.models.card import ParameterStatistics
from test.core.surfaces import sphere_surface

STATISTICS = ParameterStatistics(
    np.array([0.3, 0.3, 0.3, 0.1, 0.1]), np.array([0.2, 0.2, 0.2, 0.15, 0.06])
)


def test_guessing_sees_nothing():
    assert guess_mean(STATISTICS).tolist() == STATISTICS.mean.tolist()


def test_a_matt_surface_in_even_light_is_found_exactly():
    surface = sphere_surface(50, 30)
    rho_d = np.array([0.1, 0.4, 0.8])
    light = np.random.default_rng(0).uniform(0.3, 0.9, (30, 3))
    background = 255 * srgb.encode(light)
    foreground = 255 * srgb.encode(rho_d * light)
    background[3], foreground[4] = np.nan, np.nan
    seen = dataclasses.replace(surface, view_foreground=foreground, view_background=background)
    estimate = lambertian(seen, STATISTICS)
    np.testing.assert_allclose(estimate[:3], rho_d, atol=1e-6)
    assert estimate[3:].tolist() == [0.0, 0.1]


def test_the_optimiser_looks_at_the_view_that_saw_most():
    surface = sphere_surface(80, 20, seed=3)
    view = int(np.bincount(surface.view_indices).argmax())
    looked = fullest_view(surface)
    rows = surface.view_indices == view
    assert len(looked.colours) == rows.sum()
    np.testing.assert_allclose(looked.colours * 255, surface.colours[rows], atol=1e-3)
    # omega_o of each observation, in a frame whose +z is the normal.
    np.testing.assert_allclose(looked.omega_o.norm(dim=1), 1, atol=1e-5)
    assert (looked.omega_o[:, 2] > 0.2).all()


def test_the_optimiser_undoes_its_own_rendering():
    torch.manual_seed(0)
    surface = sphere_surface(100, 3, seed=5)
    view = fullest_view(surface)
    prior, effort = Prior(), Effort(steps=80, starts=(0.1,), learning_rate=0.1, strata=4)
    problem = _Problem(view, STATISTICS, effort, prior)
    truth = torch.tensor([0.1, 0.3, 0.6, 0.05, 0.12])
    light = torch.full((16, 32, 3), float(np.exp(prior.log_mean)))
    light[3:6, 23:27] = 6.0
    seen = srgb.encode(problem._radiance(truth, light))
    problem = _Problem(dataclasses.replace(view, colours=seen), STATISTICS, effort, prior)
    _, estimate = problem.solve(0.1)
    guess = np.abs(STATISTICS.mean[:3] - truth[:3].numpy()).mean()
    # The light's scale is unknown, so the priors keep it from the truth, but not its colour.
    assert np.abs(estimate[:3] - truth[:3].numpy()).mean() < 0.75 * guess
    assert estimate[0] < 0.7 * estimate[1] < 0.7 * estimate[2]


def test_what_the_optimiser_varies_is_always_physical():
    ward = _ward(torch.tensor([-50.0, 0.0, 50.0, -50.0, -50.0]))
    assert ward[:4].min() >= 0
    assert ward[:4].max() <= 1
    assert ward[4] == pytest.approx(0.002)
