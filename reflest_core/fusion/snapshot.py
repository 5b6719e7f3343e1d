# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A frozen copy of the store for the estimator, of bounded size."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.normal_smoothing import smoothed_normals
from reflest_core.fusion.observations.observation_store import ObservationStore
from reflest_core.fusion.observations.views import ViewTable
from reflest_core.fusion.settings import FusionSettings
from reflest_core.fusion.work_sharing import share_out
from reflest_core.light.exposure_correction import at_one_exposure, means_at_one_exposure
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.thinning import thinned

LEAST_SHARE = 1024
"""Fewer normals than this are not worth waking another thread."""

MOST_VOXELS = 10_000
"""A larger store is thinned, so that neither the copy nor an estimate from it costs more."""
MATERIAL_VOXELS = 60_000
"""The same where the surface is divided into materials: neighbours must not be thinned away."""


def observed_surface(
    store: ObservationStore,
    views: ViewTable,
    settings: FusionSettings,
    most_voxels: int = MOST_VOXELS,
    centre: NDArray[np.float64] | None = None,
) -> ObservedSurface:
    """Copy the observed voxels of a store, their observations and their views.

    Where the camera's exposure changed, the colours are those of the common exposure.

    Args:
        store: Voxels and their observations.
        views: The views that the observations belong to; view indices are view ids.
        settings: Voxel size, smoothing of normals and threads.
        most_voxels: Of a larger store so many voxels are copied.
        centre: (3,) the copied voxels are those nearest to it; None spreads them evenly.

    Returns:
        The surface without its light.
    """
    rows = store.rows
    if centre is None:
        selected = thinned(rows.counts[: store.count], most_voxels)
    else:
        selected = _nearest(store, centre, most_voxels)
    offsets = np.zeros(len(selected) + 1, np.int64)
    np.cumsum(rows.counts[selected], out=offsets[1:], dtype=np.int64)
    colours, view_ids = store.observations(selected, settings.threads)
    gains = views.gains[: views.count]
    return ObservedSurface(
        positions=rows.positions[selected],
        normals=_normals(store, selected, settings),
        offsets=offsets,
        colours=at_one_exposure(colours, gains, view_ids),
        view_indices=view_ids,
        view_centres=views.centres[: views.count].copy(),
        view_foreground=means_at_one_exposure(views.foreground[: views.count], gains),
        view_background=means_at_one_exposure(views.background[: views.count], gains),
        keys=rows.keys[selected],
        voxel_size=settings.voxel_size,
    )


def _nearest(store: ObservationStore, centre: NDArray[np.float64], most: int) -> NDArray[np.int64]:
    """Rows of the observed voxels that are nearest to a point, rising."""
    rows = store.rows
    observed = np.flatnonzero(rows.counts[: store.count])
    if len(observed) <= most:
        return observed
    away = rows.positions[observed] - centre.astype(np.float32)
    nearest = np.argpartition(np.einsum("ij,ij->i", away, away), most)[:most]
    return np.sort(observed[nearest])


def _normals(
    store: ObservationStore, selected: NDArray[np.int64], settings: FusionSettings
) -> NDArray[np.float32]:
    normals: NDArray[np.float32] = store.rows.normals[selected]
    if settings.normal_smoothing > 0.0:
        share_out(
            settings.threads,
            len(selected),
            LEAST_SHARE,
            smoothed_normals,
            store.rows,
            selected,
            settings.voxel_size,
            math.radians(settings.normal_smoothing),
            normals,
        )
    return normals
