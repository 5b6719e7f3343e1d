# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A frozen copy of the store for the estimator, of bounded size."""

from __future__ import annotations

import numpy as np

from reflest_core.fusion.observation_store import ObservationStore
from reflest_core.fusion.observed_surface import ObservedSurface
from reflest_core.fusion.thinning import thinned
from reflest_core.fusion.views import ViewTable

MOST_VOXELS = 10_000
"""A larger store is thinned, so that neither the copy nor an estimate from it costs more."""


def observed_surface(store: ObservationStore, views: ViewTable) -> ObservedSurface:
    """Copy :data:`MOST_VOXELS` voxels with observations at most; view indices are view ids."""
    rows = store.rows
    selected = thinned(rows.counts[: store.count], MOST_VOXELS)
    offsets = np.zeros(len(selected) + 1, np.int64)
    np.cumsum(rows.counts[selected], out=offsets[1:], dtype=np.int64)
    colours, view_ids = store.observations(selected)
    return ObservedSurface(
        positions=rows.positions[selected],
        normals=rows.normals[selected],
        offsets=offsets,
        colours=colours,
        view_indices=view_ids,
        view_centres=views.centres[: views.count].copy(),
        view_foreground=views.foreground[: views.count].copy(),
        view_background=views.background[: views.count].copy(),
    )
