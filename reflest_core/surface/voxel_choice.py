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
STRETCH = 32
"""Points in a row that are compared with a new centre together: neighbours, for the most part."""
SURELY = 1.0 - 1e-9
"""Against the rounding of squared distances."""


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

    The first centre is the point farthest from the mean. Stretches of points that are all nearer to
    their own centres than to the box around the stretch are left as they are.
    """
    total = points.shape[1]
    clusters = np.zeros(total, np.int32)
    nearest = np.full(total, np.inf)
    stretches = (total + STRETCH - 1) // STRETCH
    boxes, farthest = _boxes(points, stretches), np.full(stretches, np.inf)
    squared, c = np.empty(STRETCH), np.empty(len(points))
    centre = int(np.argmax((points * points).sum(axis=0)))
    for cluster in range(count):
        for axis in range(len(points)):
            c[axis] = points[axis, centre]
        greatest, where = -1.0, 0
        for n in range(stretches):
            first, last = n * STRETCH, min((n + 1) * STRETCH, total)
            if _squared_distance(c, boxes[:, n]) * SURELY < farthest[n]:
                for p in range(first, last):
                    squared[p - first] = (
                        (points[0, p] - c[0]) ** 2
                        + (points[1, p] - c[1]) ** 2
                        + (points[2, p] - c[2]) ** 2
                        + (points[3, p] - c[3]) ** 2
                        + (points[4, p] - c[4]) ** 2
                        + (points[5, p] - c[5]) ** 2
                    )
                for p in range(first, last):
                    is_nearer = squared[p - first] < nearest[p]
                    nearest[p] = squared[p - first] if is_nearer else nearest[p]
                    clusters[p] = cluster if is_nearer else clusters[p]
                farthest[n] = 0.0
                for p in range(first, last):
                    farthest[n] = max(farthest[n], nearest[p])
            if farthest[n] > greatest:
                greatest, where = farthest[n], n
        centre = where * STRETCH
        while nearest[centre] < greatest:
            centre += 1
    return clusters


@compiled
def _boxes(points: NDArray[np.float64], stretches: int) -> NDArray[np.float64]:
    """(12, S) least and greatest coordinates, by turns, of each stretch of points (6, P)."""
    boxes = np.empty((2 * len(points), stretches))
    for axis in range(len(points)):
        for n in range(stretches):
            part = points[axis, n * STRETCH : (n + 1) * STRETCH]
            boxes[2 * axis, n], boxes[2 * axis + 1, n] = part.min(), part.max()
    return boxes


@compiled
def _squared_distance(point: NDArray[np.float64], box: NDArray[np.float64]) -> float:
    squared = 0.0
    for axis in range(len(point)):
        outside = max(box[2 * axis] - point[axis], point[axis] - box[2 * axis + 1], 0.0)
        squared += outside * outside
    return squared


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
