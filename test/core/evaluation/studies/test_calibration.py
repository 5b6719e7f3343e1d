# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Calibration counts what is inside the stated intervals, and nothing else."""

import numpy as np
import pytest

from reflest_core.evaluation.estimates import SceneEstimates
from reflest_core.evaluation.studies.calibration import LEVELS, half_width, measure_calibration
from reflest_core.models.card import ParameterStatistics
from reflest_core.training.data.sample import Sample

STATISTICS = ParameterStatistics(np.full(5, 0.3), np.array([0.2, 0.2, 0.2, 0.3, 0.05]))
SCENES = 4000


def estimated(factor, statuses=None, seed=0):
    """Estimates whose true deviations are ``factor`` times those that they state."""
    rng = np.random.default_rng(seed)
    stddev = rng.uniform(0.02, 0.3, (SCENES, 5))
    truths = rng.uniform(0, 1, (SCENES, 5))
    wards = truths + factor * stddev * rng.normal(size=(SCENES, 5))
    samples = [Sample(None, ward, f"e{k % 20}", k) for k, ward in enumerate(truths)]
    return SceneEstimates(wards, stddev, statuses or ["OK"] * SCENES), samples


def test_the_half_width_of_ninety_per_cent_is_the_normal_distributions():
    assert half_width(0.9) == pytest.approx(1.6449, abs=1e-4)
    assert half_width(0.5) == pytest.approx(0.6745, abs=1e-4)


def test_true_deviations_are_reliable_at_every_level():
    measured = measure_calibration(*estimated(1.0), STATISTICS)
    np.testing.assert_allclose(
        measured["observed"], np.tile(np.array(LEVELS)[:, None], 5), atol=0.03
    )
    np.testing.assert_allclose(measured["z_stddev"], 1, atol=0.05)
    np.testing.assert_allclose(measured["inside"], 0.9, atol=0.02)
    for share, around in zip(measured["inside"], measured["inside_intervals"], strict=True):
        assert around.low < share < around.high


@pytest.mark.parametrize(("factor", "inside"), [(2.0, 0.589), (0.5, 0.999)])
def test_deviations_that_are_stated_wrongly_show(factor, inside):
    # 2 Phi(1.645 / factor) - 1
    measured = measure_calibration(*estimated(factor), STATISTICS)
    np.testing.assert_allclose(measured["inside"], inside, atol=0.025)
    np.testing.assert_allclose(measured["z_stddev"], factor, rtol=0.05)


def test_quarters_go_from_what_is_sure_to_what_is_not():
    measured = measure_calibration(*estimated(1.0), STATISTICS)
    stated = [group["expected"] for group in measured["quartiles"]]
    errors = [group["rmse"] for group in measured["quartiles"]]
    assert stated == sorted(stated)
    np.testing.assert_allclose(errors, stated, rtol=0.06)
    assert sum(group["scenes"] for group in measured["quartiles"]) == SCENES


def test_statuses_are_counted_with_the_error_of_their_estimates():
    made, samples = estimated(1.0)
    flagged = np.arange(SCENES) % 4 == 0
    made.ward[flagged] = np.stack([s.ward for s in samples])[flagged] + 2 * STATISTICS.stddev
    statuses = np.where(flagged, "LOW_COVERAGE", "OK").tolist()
    made = SceneEstimates(made.ward, made.stddev, statuses)
    rows = {
        row["status"]: row for row in measure_calibration(made, samples, STATISTICS)["statuses"]
    }
    assert rows["LOW_COVERAGE"]["share"] == 0.25
    assert rows["LOW_COVERAGE"]["rmse"] == pytest.approx(2)
    np.testing.assert_allclose(rows["LOW_COVERAGE"]["per_parameter"], 2)
    assert rows["any but OK"]["scenes"] == SCENES // 4
    assert rows["OK"]["scenes"] == 3 * SCENES // 4
    assert rows["FEW_VOXELS"]["rmse"] is None
