# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The headline figure by hand."""

import numpy as np
import pytest

from reflest_core.models.card import ParameterStatistics
from reflest_core.training.metrics import normalised_rmse


def test_normalised_rmse_by_hand():
    statistics = ParameterStatistics(np.full(5, 0.5), np.array([0.1, 0.1, 0.1, 0.2, 0.2]))
    truths = np.full((2, 5), 0.5)
    estimates = truths.copy()
    estimates[0, 0] += 0.2  # two standard deviations in one of ten values
    rmse = normalised_rmse(estimates, truths, statistics)
    assert rmse.overall == pytest.approx(np.sqrt(4 / 10))
    np.testing.assert_allclose(rmse.per_parameter, [np.sqrt(2), 0, 0, 0, 0])
    assert rmse.scene_mean == pytest.approx(np.sqrt(4 / 5) / 2)
    assert rmse.scene_median == pytest.approx(np.sqrt(4 / 5) / 2)


def test_guessing_the_mean_of_the_training_set_scores_one():
    rng = np.random.default_rng(0)
    truths = rng.random((5000, 5))
    statistics = ParameterStatistics.of(truths)
    guesses = np.tile(statistics.mean, (5000, 1))
    assert normalised_rmse(guesses, truths, statistics).overall == pytest.approx(1)
