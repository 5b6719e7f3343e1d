# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A frozen copy of the store for the estimator, of bounded size."""

from __future__ import annotations

import numpy as np

from reflest_core.fusion.observations.observation_store import ObservationStore
from reflest_core.fusion.observations.views import ViewTable
from reflest_core.light.exposure_correction import at_one_exposure, means_at_one_exposure
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.thinning import thinned

MOST_VOXELS = 10_000
"""A larger store is thinned, so that neither the copy nor an estimate from it costs more."""


def observed_surface(
    store: ObservationStore, views: ViewTable, threads: int = 1, most_voxels: int = MOST_VOXELS
) -> ObservedSurface:
    """Copy the observed voxels of a store, their observations and their views.

    Where the camera's exposure changed, the colours are those of the common exposure.

    Args:
        store: Voxels and their observations.
        views: The views that the observations belong to; view indices are view ids.
        threads: Threads that share the work.
        most_voxels: A larger store is thinned evenly to so many voxels.

    Returns:
        The surface without its light.
    """
    rows = store.rows
    selected = thinned(rows.counts[: store.count], most_voxels)
    offsets = np.zeros(len(selected) + 1, np.int64)
    np.cumsum(rows.counts[selected], out=offsets[1:], dtype=np.int64)
    colours, view_ids = store.observations(selected, threads)
    gains = views.gains[: views.count]
    return ObservedSurface(
        positions=rows.positions[selected],
        normals=rows.normals[selected],
        offsets=offsets,
        colours=at_one_exposure(colours, gains, view_ids),
        view_indices=view_ids,
        view_centres=views.centres[: views.count].copy(),
        view_foreground=means_at_one_exposure(views.foreground[: views.count], gains),
        view_background=means_at_one_exposure(views.background[: views.count], gains),
        keys=rows.keys[selected],
    )
