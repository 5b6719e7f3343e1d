# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the object's own voxels tell of a frame's exposure, where the background's parallax cannot.

A voxel is compared with itself as the nearest view saw it, so that gloss moves little between them.
"""

from __future__ import annotations

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
    """Stops from a frame's ``colours`` (R, 3) of the voxels ``rows`` (R,) to what is known of them.

    At most :data:`MOST_VOXELS`, of those that are neither new, nor dark, nor clipped.
    ``camera_centre``: (3,), world frame, metres.
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
