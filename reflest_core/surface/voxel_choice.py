# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Choosing the few voxels that stand for the surface, by clustering position and normal (3.3.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, vectorised
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.thinning import thinned

MIN_OBSERVATIONS = 5
"""A voxel seen less often is chosen only where there are too few others."""

MOST_CANDIDATES = 2048
"""Voxels that are clustered; a larger surface is thinned, so that the choice costs no more."""
LANES = 64
"""Maxima that are taken beside one another, by vector instructions."""


def choose_voxels(surface: ObservedSurface, count: int) -> NDArray[np.int64]:
    """Choose voxels that differ most in position and normal.

    Clusters are Gonzalez' k-centres (1985) of the points ``(position / radius, normal)``, where
    ``radius`` is the surface's RMS extent, so that position and normal weigh alike; a cluster is
    represented by its most often observed voxel. Deterministic. Voxels without observations are
    never chosen.

    Args:
        surface: What was observed.
        count: Most voxels.

    Returns:
        At most ``count`` indices, rising: one for each cluster.
    """
    observations = surface.observation_counts
    candidates = thinned(observations, MOST_CANDIDATES)
    eligible = candidates[observations[candidates] >= MIN_OBSERVATIONS]
    if len(eligible) < count:
        eligible = candidates
    if len(eligible) <= count:
        return eligible
    positions = surface.positions[eligible].astype(np.float64)
    centred = positions - positions.mean(axis=0)
    radius = max(float(np.sqrt((centred**2).sum(axis=1).mean())), 1e-9)
    points = np.concatenate([centred / radius, surface.normals[eligible]], axis=1)
    clusters = _k_centre_clusters(np.ascontiguousarray(points.T), count)
    return np.sort(eligible[_most_observed(clusters, observations[eligible], count)])


@vectorised
def _k_centre_clusters(points: NDArray[np.float64], count: int) -> NDArray[np.int32]:
    """Cluster (P,) of each of the ``points`` (6, P): each centre is farthest from those before it.

    The first centre is the point farthest from the mean.
    """
    clusters = np.zeros(points.shape[1], np.int32)
    nearest = np.full(points.shape[1], np.inf)
    squared, lanes = np.empty(points.shape[1]), np.empty(LANES)
    centre = int(np.argmax((points * points).sum(axis=0)))
    for cluster in range(count):
        c = points[:, centre].copy()
        for p in range(len(squared)):
            squared[p] = (
                (points[0, p] - c[0]) ** 2
                + (points[1, p] - c[1]) ** 2
                + (points[2, p] - c[2]) ** 2
                + (points[3, p] - c[3]) ** 2
                + (points[4, p] - c[4]) ** 2
                + (points[5, p] - c[5]) ** 2
            )
        for p in range(len(squared)):
            is_nearer = squared[p] < nearest[p]
            nearest[p] = squared[p] if is_nearer else nearest[p]
            clusters[p] = cluster if is_nearer else clusters[p]
        centre, farthest = 0, _greatest(nearest, lanes)
        while nearest[centre] < farthest:
            centre += 1
    return clusters


@vectorised
def _greatest(values: NDArray[np.float64], lanes: NDArray[np.float64]) -> float:
    """The greatest of ``values`` (P,), none negative, by way of those of each of the ``lanes``."""
    lanes[:] = 0.0
    for first in range(0, len(values), len(lanes)):
        part = values[first : first + len(lanes)]
        for lane in range(len(part)):
            lanes[lane] = max(lanes[lane], part[lane])
    greatest = 0.0
    for lane in range(len(lanes)):
        greatest = max(greatest, lanes[lane])
    return greatest


@compiled
def _most_observed(
    clusters: NDArray[np.int32], observations: NDArray[np.int64], count: int
) -> NDArray[np.int64]:
    """Index of the most often observed point of every cluster that has one, by cluster."""
    best = np.full(count, -1, np.int64)
    for point in range(len(clusters)):
        known = best[clusters[point]]
        if known < 0 or observations[point] > observations[known]:
            best[clusters[point]] = point
    return best[best >= 0]
