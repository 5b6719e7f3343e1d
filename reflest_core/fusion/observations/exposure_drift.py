# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Whether the camera's exposure changed in mid-scan, which colours cannot tell from reflectance."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import LUMINANCE_WEIGHTS
from reflest_core.brdf.srgb import decode
from reflest_core.fusion.observations.views import ViewTable

LEAST_VIEWS = 12
"""Fewer views say nothing."""


def exposure_drift(views: ViewTable) -> float:
    """By how many stops the newest third of the views is brighter than the oldest; NaN if unknown.

    Compares the median luminance of F and of B (mean colours of foreground and background). Only
    the change that both share is told, for what the camera looks at changes them one by one. Light
    that changes cannot be told from exposure. Unknown below ``LEAST_VIEWS`` views, and where no
    view has a background.
    """
    order = np.argsort(views.order[: views.count])
    foreground = _brightening(views.foreground[: views.count][order])
    background = _brightening(views.background[: views.count][order])
    if math.isnan(foreground) or math.isnan(background):
        return math.nan
    if foreground * background <= 0.0:
        return 0.0
    return min(foreground, background, key=abs)


def _brightening(colours: NDArray[np.float32]) -> float:
    """Stops from the first to the last third of (W, 3) mean 8-bit colours, NaN where unknown."""
    luminance = decode(colours.astype(np.float64) / 255.0) @ LUMINANCE_WEIGHTS
    known = luminance[luminance > 0.0]
    if len(known) < LEAST_VIEWS:
        return math.nan
    third = len(known) // 3
    return math.log2(float(np.median(known[-third:])) / float(np.median(known[:third])))
