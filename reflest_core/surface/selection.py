# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Parts of an observed surface: some of its voxels, or what some of its views saw."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from reflest_core.surface.observed_surface import ObservedSurface


def keep_voxels(surface: ObservedSurface, voxels: NDArray[np.int64]) -> ObservedSurface:
    """Select voxels together with their observations; views and light stay.

    Args:
        surface: V voxels.
        voxels: (N,) indices into the voxels, in any order, each at most once.

    Returns:
        The surface of the N voxels, in the given order.
    """
    counts = surface.observation_counts[voxels]
    offsets = np.zeros(len(voxels) + 1, np.int64)
    np.cumsum(counts, out=offsets[1:])
    rows = np.arange(offsets[-1]) - np.repeat(offsets[:-1] - surface.offsets[voxels], counts)
    return dataclasses.replace(
        surface,
        positions=surface.positions[voxels],
        normals=surface.normals[voxels],
        offsets=offsets,
        colours=surface.colours[rows],
        view_indices=surface.view_indices[rows],
        keys=None if surface.keys is None else surface.keys[voxels],
    )


def keep_views(surface: ObservedSurface, views: NDArray[np.int64]) -> ObservedSurface:
    """Select the observations that were made from some of the views; voxels stay.

    Args:
        surface: W views.
        views: (N,) indices of the views to keep.

    Returns:
        The surface with the view arrays as they were and the other views' observations gone.
    """
    kept = np.zeros(len(surface.view_centres), np.bool_)
    kept[views] = True
    seen = kept[surface.view_indices]
    running = np.concatenate([[0], np.cumsum(seen)])
    return dataclasses.replace(
        surface,
        offsets=running[surface.offsets],
        colours=surface.colours[seen],
        view_indices=surface.view_indices[seen],
    )
