# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The camera's exposure, estimated from stored views."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.brdf.lab import LUMINANCE_WEIGHTS
from reflest_core.fusion.observations.observation_store import ObservationStore
from reflest_core.fusion.observations.views import ViewTable
from reflest_core.light.exposure_gain import DARKEST

MOST_VOXELS = 400
"""More are thinned evenly."""


def surface_shifts(
    store: ObservationStore,
    views: ViewTable,
    rows: NDArray[np.int64],
    colours: NDArray[np.uint8],
    camera_centre: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Compare a frame's colours of voxels with what is known of them.

    A voxel is compared with itself as the nearest view saw it, so that gloss moves little between
    them. Voxels that are new, dark or clipped are left out.

    Args:
        store: The stored observations.
        views: The stored views.
        rows: (R,) rows of voxels that the frame sees.
        colours: (R, 3) 8-bit sRGB, their colours in the frame.
        camera_centre: (3,) world frame, metres.

    Returns:
        Stops from the frame to the common exposure, of at most :data:`MOST_VOXELS` voxels.
    """
    is_known = store.rows.counts[rows] > 0
    rows, colours = rows[is_known], colours[is_known]
    if len(rows) == 0:
        return np.empty(0)
    chosen = np.unique(np.linspace(0, len(rows) - 1, MOST_VOXELS).astype(np.int64))
    rows, colours = rows[chosen], colours[chosen]
    before, view_ids = store.observations(rows)
    counts = store.rows.counts[rows].astype(np.int64)
    owner = np.repeat(np.arange(len(rows)), counts)
    away = np.linalg.norm(views.centres[view_ids] - camera_centre, axis=1)
    nearest = np.lexsort((away, owner))[np.cumsum(counts) - counts]
    before, gains = before[nearest], views.gains[view_ids[nearest]]
    is_clear = (before.max(axis=1) < 255) & (colours.max(axis=1) < 255)
    here, there = (
        (srgb.LINEAR[part] * LUMINANCE_WEIGHTS).sum(axis=1) for part in (colours, before)
    )
    is_clear &= here * there > DARKEST**2
    shifts = np.log2(there[is_clear] * gains[is_clear] / here[is_clear])
    return np.asarray(shifts, np.float64)


LEAST_VIEWS = 12
"""Fewer views say nothing."""


def exposure_drift(views: ViewTable) -> float:
    """Measure by how much the newest third of the views is brighter than the oldest.

    Compares the median luminance of F and of B (mean colours of foreground and background). Only
    the change that both share counts, for what the camera looks at changes them one by one. Light
    that changes cannot be distinguished from exposure.

    Args:
        views: The stored views.

    Returns:
        Stops; NaN below ``LEAST_VIEWS`` views, and where no view has a background.
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
    luminance = srgb.decode(colours.astype(np.float64) / 255.0) @ LUMINANCE_WEIGHTS
    known = luminance[luminance > 0.0]
    if len(known) < LEAST_VIEWS:
        return math.nan
    third = len(known) // 3
    return math.log2(float(np.median(known[-third:])) / float(np.median(known[:third])))
