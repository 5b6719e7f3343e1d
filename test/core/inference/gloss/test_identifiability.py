# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How sure a roughness is: by its likelihood, by the agreement of parts, by what they hold."""

import numpy as np
import pytest

from reflest_core.inference.gloss.identifiability import (
    EDGE_ERROR,
    FEWEST_VOXELS,
    LEAST_GAIN,
    MODEL_ERROR,
    identifiability,
)

ALPHAS = np.geomspace(0.01, 0.35, 12)
NOTHING = np.zeros(12)
ENOUGH = {"matte": -9999.0, "effective_voxels": FEWEST_VOXELS}


def parts(centres, width=0.3, weight=10.0):
    """Log-likelihoods of parts whose maxima lie at ``centres``."""
    logs = np.log(ALPHAS)
    return np.stack([-0.5 * weight * ((logs - np.log(c)) / width) ** 2 for c in centres])


def test_parts_that_agree_give_a_sharp_answer():
    sharp = np.tile(-50.0 * ((ALPHAS - 0.055) / 0.055) ** 2, (8, 1))
    found = identifiability(ALPHAS, sharp, NOTHING, **ENOUGH)
    assert found.reason == ""
    assert np.exp(found.log_alpha) == pytest.approx(0.055, rel=0.01)
    assert found.log_alpha_stddev == pytest.approx(MODEL_ERROR, rel=0.1)
    assert found.probability.sum() == pytest.approx(1.0)


def test_the_stated_deviation_is_that_of_the_mean_of_disagreeing_parts():
    rng = np.random.default_rng(0)
    spread = 0.6
    stated, made = [], []
    for _ in range(200):
        centres = np.exp(np.log(0.06) + spread * rng.normal(size=8))
        found = identifiability(ALPHAS, parts(centres), NOTHING, **ENOUGH)
        stated.append(found.log_alpha_stddev**2 - MODEL_ERROR**2)
        made.append(found.log_alpha - np.log(0.06))
    assert np.sqrt(np.median(stated)) == pytest.approx(np.std(made), rel=0.3)
    assert np.std(made) == pytest.approx(spread / np.sqrt(8), rel=0.3)


@pytest.mark.parametrize(
    ("centres", "changed", "reason"),
    [
        ([0.05] * 8, {"effective_voxels": 0.9 * FEWEST_VOXELS}, "54 voxels"),
        ([0.05] * 8, {"clipped_share": 0.6}, "60% of the highlights are overexposed"),
        ([0.05] * 8, {"matte": 1.0 - LEAST_GAIN}, "39, 40 are needed"),
        ([0.01] * 4 + [0.3] * 4, {}, "disagree"),
    ],
)
def test_what_is_missing_is_named(centres, changed, reason):
    found = identifiability(ALPHAS, parts(centres), NOTHING, **{**ENOUGH, **changed})
    assert reason in found.reason


@pytest.mark.parametrize("edge", [0.005, 0.8])
def test_beyond_the_compared_roughnesses_the_deviation_is_larger(edge):
    found = identifiability(ALPHAS, parts([edge] * 8), NOTHING, **ENOUGH)
    assert found.log_alpha_stddev >= EDGE_ERROR


def test_what_else_was_fitted_counts_too():
    prior = parts([0.2], weight=1e3)[0]
    found = identifiability(ALPHAS, parts([0.05] * 8), prior, **ENOUGH)
    assert np.exp(found.log_alpha) > 0.1
