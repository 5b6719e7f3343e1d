# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Standard deviations are calibrated on what was held out."""

import numpy as np
import pytest

from reflest_core.models.card import Calibration
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light.calibration import fitted_calibration
from reflest_core.training.light.measured_scans import HALF_WIDTH, HELD_OUT, MeasuredScans


def erring(errors, deviations=None, environments=None):
    """Scans that err so, all of them under one light or under ``environments``."""
    count = len(errors)
    return MeasuredScans(
        errors,
        np.ones((count, 5)) if deviations is None else deviations,
        np.full(count, 100),
        np.full(count, "room") if environments is None else environments,
    )


def rms(errors):
    return np.sqrt((errors**2).mean())


def test_every_light_counts_alike():
    """Of 1,100 scans 1,000 are under a light in which errors are as stated, 100 ten times as large.

    So the interval is to hold four in five of the large errors, and all of the small ones.
    """
    rng = np.random.default_rng(6)
    size = np.repeat([1.0, 10.0], [1000, 100])[:, None]
    environments = np.repeat(["even", "dark"], [1000, 100])
    errors = rng.normal(size=(1100, 5)) * size
    factors = fitted_calibration(erring(errors, environments=environments)).factors
    np.testing.assert_allclose(factors, 10.0 * 1.2816 / HALF_WIDTH, rtol=0.2)


def test_ninety_percent_intervals_hold_ninety_percent_where_it_is_sure_and_where_not():
    rng = np.random.default_rng(3)
    deviations = rng.uniform(0.02, 1.0, (6000, 5))
    sharper = np.array([2.0, 2.0, 2.0, 4.0, 0.1])
    power = np.array([1.3, 1.3, 1.3, 1.0, 0.7])
    errors = rng.standard_t(4, (6000, 5)) * deviations**power * sharper
    found = fitted_calibration(erring(errors, deviations))
    np.testing.assert_allclose(found.powers, power, atol=0.05)
    held = np.abs(errors) <= HALF_WIDTH * found.calibrated(deviations)
    np.testing.assert_allclose(held[:, 3:].mean(axis=0), 0.9, atol=0.002)
    np.testing.assert_allclose(held[:, :3].mean(), 0.9, atol=0.001)
    for k in range(5):
        by_deviation = held[np.argsort(deviations[:, k]), k]
        shares = [part.mean() for part in np.array_split(by_deviation, 4)]
        np.testing.assert_allclose(shares, 0.9, atol=0.03)


def test_deviations_that_are_all_alike_only_need_a_factor():
    errors = np.random.default_rng(2).normal(size=(3000, 5))
    found = fitted_calibration(erring(errors))
    np.testing.assert_array_equal(found.powers, 1.0)
    np.testing.assert_allclose(found.factors, 1.0, rtol=0.1)


def test_colour_channels_share_their_calibration():
    rng = np.random.default_rng(5)
    deviations = rng.uniform(0.1, 1.0, (4000, 5))
    errors = rng.normal(size=(4000, 5)) * [1.0, 1.0, 2.0, 1.0, 1.0] * deviations
    found = fitted_calibration(erring(errors, deviations))
    for values in (found.factors, found.powers):
        assert (values[:3] == values[0]).all()
    assert 1.2 < found.factors[0] < 1.7
    assert abs(found.factors[3] - 1.0) < 0.1


def test_correlated_errors_are_measured():
    rng = np.random.default_rng(4)
    shared = rng.normal(size=(4000, 1))
    errors = np.concatenate(
        [0.8 * shared + 0.6 * rng.normal(size=(4000, 3)), rng.normal(size=(4000, 2))], axis=1
    )
    found = fitted_calibration(erring(errors)).correlation
    np.testing.assert_allclose(found[:3, :3] - np.eye(3) * 0.36, 0.64, atol=0.05)
    np.testing.assert_allclose(found[3, :3], 0.0, atol=0.05)


def test_what_was_held_out_comes_back_joined(tmp_path):
    some = []
    for k, name in enumerate(("dim", "noon")):
        folder = tmp_path / name
        folder.mkdir()
        rng = np.random.default_rng(k)
        one = erring(rng.normal(size=(3, 5)), rng.uniform(0.1, 1, (3, 5)), np.full(3, name))
        one.save(folder)
        some.append(MeasuredScans.read(folder))
        np.testing.assert_array_equal(some[-1].errors, one.errors)
        np.testing.assert_array_equal(some[-1].deviations, one.deviations)
    joined = MeasuredScans.joined(some)
    np.testing.assert_array_equal(joined.errors[3:], some[1].errors)
    assert joined.lights == ["dim", "noon"]
    assert joined.environments.tolist() == ["dim"] * 3 + ["noon"] * 3
    by_light = joined.figures(Calibration())["100"]["rmse_by_light"]
    assert by_light == {
        "dim": pytest.approx(rms(some[0].errors)),
        "noon": pytest.approx(rms(some[1].errors)),
    }


def test_a_damaged_file_is_named(tmp_path):
    (tmp_path / HELD_OUT).write_bytes(b"PK no archive")
    with pytest.raises(TrainingError, match=f"{HELD_OUT} is damaged"):
        MeasuredScans.read(tmp_path)
