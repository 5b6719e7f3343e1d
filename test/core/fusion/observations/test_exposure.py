# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Exposure drift: known gains, a moving camera's content, and what cannot be known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from reflest_core.brdf.srgb import encode
from reflest_core.fusion.observations.exposure import LEAST_VIEWS, exposure_drift
from reflest_core.fusion.observations.views import ViewTable


def table(foreground, background, capacity=None):
    """Views with these linear grey levels; encoded as the camera would."""
    views = ViewTable(capacity or len(foreground))
    for f, b in zip(foreground, background, strict=True):
        colours = [np.full(3, 255.0 * encode(np.float64(x)), np.float32) for x in (f, b)]
        if views.is_full:
            views.forget(views.oldest())
        views.put(np.zeros(3), *colours, 0)
    return views


@pytest.mark.parametrize("stops", [-1.5, -0.5, 0.0, 1.0])
def test_a_gain_of_both_is_given_in_stops(stops):
    gain = 2.0 ** np.repeat([0.0, stops / 2, stops], 10)
    assert exposure_drift(table(0.2 * gain, 0.1 * gain)) == pytest.approx(stops, abs=1e-4)


def test_what_the_camera_looks_at_is_no_drift():
    steady, brighter = np.full(30, 0.2), 0.1 * 2.0 ** np.repeat([0.0, 1.0, 2.0], 10)
    assert exposure_drift(table(steady, brighter)) == pytest.approx(0.0, abs=1e-4)
    assert exposure_drift(table(brighter, 0.05 / brighter)) == 0.0


def test_a_full_table_is_read_in_the_order_of_storing():
    gain = 2.0 ** np.repeat([3.0, 0.0, 0.5, 1.0], 12)
    views = table(0.05 * gain, 0.02 * gain, capacity=36)
    assert exposure_drift(views) == pytest.approx(1.0, abs=1e-4)


def test_too_little_is_unknown():
    few = np.full(LEAST_VIEWS - 1, 0.2)
    assert math.isnan(exposure_drift(table(few, few)))
    many = np.full(30, 0.2)
    assert math.isnan(exposure_drift(table(many, np.full(30, np.nan))))
