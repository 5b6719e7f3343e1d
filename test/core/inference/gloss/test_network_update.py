# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A network's roughness and the posterior, joined."""

import dataclasses

import numpy as np
import pytest

from reflest_core.inference.gloss.network_update import roughness_problem, with_posterior
from reflest_core.inference.gloss.posterior import GlossPosterior

FOUND = GlossPosterior(
    alphas=np.geomspace(0.01, 0.35, 12),
    log_likelihood=np.zeros(12),
    rho_s=np.full(12, 0.03),
    rho_d=np.full((1, 12, 3), 0.1),
    probability=np.full(12, 1 / 12),
    alpha=0.03,
    log_alpha_stddev=0.25,
    delta_log_likelihood=500.0,
    effective_voxels=200.0,
    is_identifiable=True,
    reason="",
)
WARD = np.array([0.1, 0.08, 0.05, 0.03, 0.1])
STDDEV = np.array([0.05, 0.05, 0.05, 0.01, 0.05])


def test_the_joint_roughness_lies_between_both_and_is_surer_than_either():
    ward, stddev = with_posterior(WARD, STDDEV, FOUND)
    assert FOUND.alpha < ward[4] < WARD[4]
    assert ward[4] - FOUND.alpha < 0.5 * (WARD[4] - FOUND.alpha)
    assert stddev[4] / ward[4] < min(FOUND.log_alpha_stddev, STDDEV[4] / WARD[4])
    np.testing.assert_array_equal(ward[:4], WARD[:4])
    np.testing.assert_array_equal(stddev[:4], STDDEV[:4])


def test_a_network_that_is_surer_counts_more():
    sure, unsure = (
        with_posterior(WARD, STDDEV * [1, 1, 1, 1, factor], FOUND)[0][4] for factor in (0.4, 1.6)
    )
    assert sure > unsure


def test_roughness_that_is_not_identifiable_is_the_networks():
    unknown = dataclasses.replace(FOUND, is_identifiable=False, reason="nothing is known")
    ward, stddev = with_posterior(WARD, STDDEV, unknown)
    np.testing.assert_array_equal(ward, WARD)
    np.testing.assert_array_equal(stddev, STDDEV)


@pytest.mark.parametrize("alpha", [-0.02, 0.0])
def test_a_roughness_that_cannot_be_is_taken_for_the_smallest(alpha):
    ward, stddev = with_posterior(np.append(WARD[:4], alpha), STDDEV, FOUND)
    assert 0.0 < ward[4] <= FOUND.alpha
    assert np.isfinite(stddev).all()


def test_roughness_is_a_problem_where_neither_highlights_nor_the_network_know_it():
    unknown = dataclasses.replace(FOUND, is_identifiable=False, reason="nothing is known")
    assert roughness_problem(WARD, STDDEV, unknown) == "nothing is known"
    assert roughness_problem(WARD, None, unknown) == "nothing is known"
    assert roughness_problem(WARD, STDDEV * 0.5, unknown) == ""
    assert roughness_problem(WARD, STDDEV, FOUND) == ""
