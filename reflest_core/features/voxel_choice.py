"""Choosing the few voxels that stand for the surface, by clustering position and normal (3.3.1)."""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.observed_surface import ObservedSurface

MIN_OBSERVATIONS = 5
"""A voxel seen less often is chosen only where there are too few others."""


def choose_voxels(surface: ObservedSurface, count: int) -> NDArray[np.int64]:
    """At most ``count`` voxel indices, rising: one for each cluster of position and normal.

    Clusters are Gonzalez' k-centres (1985) of the points ``(position / radius, normal)``, where
    ``radius`` is the surface's RMS extent, so that position and normal weigh alike; a cluster is
    represented by its most often observed voxel. Deterministic. Voxels without observations are
    never chosen.
    """
    observations = surface.observation_counts
    eligible = np.flatnonzero(observations >= MIN_OBSERVATIONS)
    if len(eligible) < count:
        eligible = np.flatnonzero(observations > 0)
    if len(eligible) <= count:
        return eligible
    positions = surface.positions[eligible].astype(np.float64)
    centred = positions - positions.mean(axis=0)
    radius = max(float(np.sqrt((centred**2).sum(axis=1).mean())), 1e-9)
    points = np.concatenate([centred / radius, surface.normals[eligible]], axis=1)
    clusters = _k_centre_clusters(points, count)
    return np.sort(eligible[_most_observed(clusters, observations[eligible], count)])


@numba.njit(cache=True, nogil=True)
def _k_centre_clusters(points: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Cluster (P,) of each point: centres are taken one after another, each farthest from the last.

    The first centre is the point farthest from the mean.
    """
    clusters = np.zeros(len(points), np.int64)
    squared = np.full(len(points), np.inf)
    centre = int(np.argmax((points * points).sum(axis=1)))
    for cluster in range(count):
        farthest, farthest_squared = 0, -1.0
        for p in range(len(points)):
            distance = 0.0
            for axis in range(points.shape[1]):
                distance += (points[p, axis] - points[centre, axis]) ** 2
            if distance < squared[p]:
                squared[p] = distance
                clusters[p] = cluster
            if squared[p] > farthest_squared:
                farthest, farthest_squared = p, squared[p]
        centre = farthest
    return clusters


def _most_observed(
    clusters: NDArray[np.int64], observations: NDArray[np.int64], count: int
) -> NDArray[np.int64]:
    """Index of the most often observed point of every cluster that has one."""
    order = np.lexsort((np.arange(len(clusters)), -observations, clusters))
    _, first = np.unique(clusters[order], return_index=True)
    return order[first]
