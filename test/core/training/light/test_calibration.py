# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Standard deviations are made true on what was held out."""

import numpy as np

from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.training.light.calibration import Calibration
from reflest_core.training.light.measured_looks import HALF_WIDTH, MeasuredLooks


def measured(errors, deviations=None, environments=None):
    """Looks that err so, all of them under one light or under ``environments``."""
    count = len(errors)
    return MeasuredLooks(
        errors,
        np.ones((count, 5)) if deviations is None else deviations,
        np.zeros((count, 5)),
        np.full(count, 100),
        np.full(count, "room") if environments is None else environments,
        ParameterStatistics(np.zeros(5), np.ones(5)),
    )


def test_every_light_counts_alike():
    """Of 1,100 looks 1,000 are under a light in which errors are as stated, 100 thrice as large."""
    rng = np.random.default_rng(6)
    size = np.repeat([1.0, 3.0], [1000, 100])[:, None]
    environments = np.repeat(["even", "dark"], [1000, 100])
    factors = Calibration.of(
        measured(rng.normal(size=(1100, 5)) * size, environments=environments)
    ).factors
    np.testing.assert_allclose(factors, 2.0, rtol=0.15)


def test_ninety_percent_intervals_hold_ninety_percent():
    rng = np.random.default_rng(3)
    deviations = rng.uniform(0.05, 0.5, (1000, 5))
    sharper = np.array([2.0, 2.0, 2.0, 4.0, 0.1])
    errors = rng.standard_t(4, (1000, 5)) * deviations * sharper
    found = Calibration.of(measured(errors, deviations))
    held = np.abs(errors) <= HALF_WIDTH * found.factors * deviations
    np.testing.assert_allclose(held[:, 3:].mean(axis=0), 0.9, atol=0.002)
    np.testing.assert_allclose(held[:, :3].mean(), 0.9, atol=0.001)
    np.testing.assert_allclose(found.factors / sharper, found.factors[3] / 4.0, rtol=0.15)


def test_colour_channels_share_their_factor():
    rng = np.random.default_rng(5)
    errors = rng.normal(size=(2000, 5)) * [1.0, 1.0, 2.0, 1.0, 1.0]
    factors = Calibration.of(measured(errors)).factors
    assert (factors[:3] == factors[0]).all()
    assert 1.2 < factors[0] < 1.7
    assert abs(factors[3] - 1.0) < 0.1


def test_correlated_errors_are_told():
    rng = np.random.default_rng(4)
    shared = rng.normal(size=(4000, 1))
    errors = np.concatenate(
        [0.8 * shared + 0.6 * rng.normal(size=(4000, 3)), rng.normal(size=(4000, 2))], axis=1
    )
    found = Calibration.of(measured(errors)).correlation
    np.testing.assert_allclose(found[:3, :3] - np.eye(3) * 0.36, 0.64, atol=0.05)
    np.testing.assert_allclose(found[3, :3], 0.0, atol=0.05)
