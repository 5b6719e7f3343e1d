"""A frozen copy of the store for the estimator, of bounded size."""

from __future__ import annotations

import numpy as np

from reflest_core.fusion.observation_rows import gather_observations
from reflest_core.fusion.observation_store import ObservationStore
from reflest_core.fusion.observed_surface import ObservedSurface
from reflest_core.fusion.views import ViewTable

MOST_VOXELS = 20_000
"""A larger store is thinned evenly in the order of its rows, so that estimation costs no more."""


def observed_surface(store: ObservationStore, views: ViewTable) -> ObservedSurface:
    """Copy the voxels that have observations; view indices are view ids."""
    rows = store.rows
    selected = np.flatnonzero(rows.counts[: store.count])
    if len(selected) > MOST_VOXELS:
        selected = selected[np.linspace(0, len(selected) - 1, MOST_VOXELS).astype(np.int64)]
    offsets = np.zeros(len(selected) + 1, np.int64)
    np.cumsum(rows.counts[selected], out=offsets[1:], dtype=np.int64)
    colours, view_ids = gather_observations(rows, selected, offsets)
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
