# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Standard deviations of Lab/c,d: those of many drawn BRDFs, and known values."""

import numpy as np
import pytest

from reflest_core.brdf.deviations import labcd_stddev
from reflest_core.brdf.gloss import ward_to_labcd

ALIKE = np.eye(5)
ALIKE[:3, :3] += 0.8 * (1 - np.eye(3))


@pytest.mark.parametrize("correlation", [None, ALIKE])
@pytest.mark.parametrize(
    ("ward", "stddev"),
    [
        ([0.4, 0.3, 0.2, 0.1, 0.1], [0.03, 0.03, 0.03, 0.02, 0.02]),
        ([0.6, 0.05, 0.03, 0.3, 0.05], [0.1, 0.04, 0.03, 0.1, 0.03]),
        ([0.03, 0.03, 0.03, 0.01, 0.15], [0.02, 0.02, 0.02, 0.02, 0.06]),
        ([0.02, 0.02, 0.02, 0.0, 0.01], [0.03, 0.03, 0.03, 0.03, 0.03]),
    ],
)
def test_they_are_those_of_many_draws(ward, stddev, correlation):
    ward, stddev = np.array(ward), np.array(stddev)
    drawn = np.random.default_rng(0).multivariate_normal(
        np.zeros(5), np.eye(5) if correlation is None else correlation, 200_000
    )
    drawn = ward + drawn * stddev
    drawn[:, :4] = np.clip(drawn[:, :4], 0, 1)
    drawn[:, 4] = np.maximum(drawn[:, 4], 0.001)
    expected = ward_to_labcd(drawn).std(axis=0)
    np.testing.assert_allclose(labcd_stddev(ward, stddev, correlation), expected, rtol=0.2)


def test_what_is_known_exactly_is_known_exactly_in_both():
    np.testing.assert_allclose(labcd_stddev(np.full(5, 0.2), np.zeros(5)), 0.0, atol=1e-12)


def test_grey_errors_that_go_together_leave_the_hue_alone():
    """All of the colour's error in its lightness, which an error of each channel alone halves."""
    ward, stddev = np.full(5, 0.2), np.array([0.02, 0.02, 0.02, 0.0, 0.0])
    together = np.eye(5)
    together[:3, :3] = 1.0
    apart, grey = labcd_stddev(ward, stddev), labcd_stddev(ward, stddev, together)
    assert grey[0] > 1.25 * apart[0]
    assert grey[1] < 0.05 * apart[1]
    assert grey[2] < 0.05 * apart[2]


def test_distinctness_is_as_uncertain_as_roughness():
    found = labcd_stddev(np.full(5, 0.3), np.array([0.0, 0.0, 0.0, 0.0, 0.04]))
    assert found[4] == pytest.approx(0.04)
