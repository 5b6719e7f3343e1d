# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Intervals are as wide as the scenes are unlike, and wider where scenes of a group are alike."""

import numpy as np
import pytest

from reflest_core.evaluation.statistics.bootstrap import (
    mean_of_roots_over_groups,
    over_groups,
    over_scenes,
)


def test_equal_errors_give_an_interval_of_no_width():
    interval = over_scenes(np.full(50, 0.25))
    assert (interval.low, interval.high) == (0.5, 0.5)


def test_the_interval_is_that_of_the_mean():
    rng = np.random.default_rng(0)
    squared = rng.uniform(0.0, 2.0, 400)
    interval = over_scenes(squared)
    error = squared.std() / np.sqrt(400)
    assert interval.low == pytest.approx(np.sqrt(squared.mean() - 1.96 * error), abs=0.01)
    assert interval.high == pytest.approx(np.sqrt(squared.mean() + 1.96 * error), abs=0.01)


def test_scenes_of_one_light_count_as_one():
    squared = np.repeat([0.1, 0.2, 0.5, 0.9], 100)
    lights = np.repeat(["a", "b", "c", "d"], 100).tolist()
    by_scene, by_light = over_scenes(squared), over_groups(squared, lights)
    assert by_light.high - by_light.low > 3 * (by_scene.high - by_scene.low)
    assert over_scenes(squared) == by_scene


def test_the_mean_of_roots_takes_each_parameter_s_root_first():
    squared = np.repeat([[0.04, 0.36]], 30, axis=0)
    lights = np.repeat(["a", "b", "c"], 10).tolist()
    interval = mean_of_roots_over_groups(squared, lights)
    assert (interval.low, interval.high) == pytest.approx((0.4, 0.4))


def test_of_like_parameters_the_mean_of_roots_is_the_root_of_means():
    squared = np.repeat([0.1, 0.2, 0.5, 0.9], 100)
    lights = np.repeat(["a", "b", "c", "d"], 100).tolist()
    of_five = mean_of_roots_over_groups(np.repeat(squared[:, None], 5, axis=1), lights)
    assert vars(of_five) == pytest.approx(vars(over_groups(squared, lights)))
