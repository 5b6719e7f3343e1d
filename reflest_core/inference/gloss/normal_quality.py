# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How far each voxel's normal may be off, judged by the normals around it.

Fused normals err most where their neighbours disagree: at rims, in noise, in small detail. The
spread of the neighbours' normals predicts a voxel's own error.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, kernel_array
from reflest_core.surface.observed_surface import NEIGHBOUR_RADIUS

LEAST, PER_SQUARE, MOST = 0.7, 0.008, 10.0
"""Degrees, 1 / degrees and degrees: deviation = LEAST + PER_SQUARE * spread^2, at most MOST. Fitted
to normals of fused scans with a depth camera's noise, against those of the scanned mesh."""


def normal_deviations(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    radius: float = NEIGHBOUR_RADIUS,
) -> NDArray[np.float32]:
    """Return the standard deviation of each voxel's normal about each tangent axis.

    Args:
        positions: (V, 3), metres.
        normals: (V, 3), unit.
        radius: Metres, within which voxels are neighbours.

    Returns:
        (V,) radians; :data:`MOST` degrees where a voxel has no neighbour to judge it by.
    """
    spreads = np.degrees(normal_spreads(positions, normals, radius))
    deviations = np.minimum(LEAST + PER_SQUARE * spreads**2, MOST)
    return np.radians(deviations).astype(np.float32)


def normal_spreads(
    positions: NDArray[np.float32], normals: NDArray[np.float32], radius: float = NEIGHBOUR_RADIUS
) -> NDArray[np.float64]:
    """Return the RMS angle between each voxel's normal and its neighbours'.

    Args:
        positions: (V, 3), metres.
        normals: (V, 3), unit.
        radius: Metres, within which voxels are neighbours.

    Returns:
        (V,) radians, pi where there is no neighbour.
    """
    if len(positions) == 0:
        return np.zeros(0)
    cells = np.floor((positions - positions.min(axis=0)) / np.float32(radius)).astype(np.int64) + 1
    _, rows, columns = (cells.max(axis=0) + 2).tolist()
    keys = (cells[:, 0] * rows + cells[:, 1]) * columns + cells[:, 2]
    order = np.argsort(keys, kind="stable")
    return _spreads(
        kernel_array(positions[order], np.float32),
        kernel_array(normals[order], np.float32),
        keys[order],
        order,
        rows,
        columns,
        radius,
    )


@compiled
def _spreads(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    keys: NDArray[np.int64],
    order: NDArray[np.int64],
    rows: int,
    columns: int,
    radius: float,
) -> NDArray[np.float64]:
    """Spreads (V,) in the original order; the other arrays are sorted by the ``keys`` of cells."""
    totals, counts = np.zeros(len(keys)), np.zeros(len(keys), np.int64)
    limit = radius * radius
    # Where each line of three cells begins; the keys rise, and so do the lines' places. Each pair
    # is met once, at its first voxel: what comes later lies in the same line or in four more.
    steps = (0, columns, rows * columns - columns, rows * columns, rows * columns + columns)
    firsts = np.zeros(5, np.int64)
    for voxel in range(len(keys)):
        for line in range(5):
            middle = keys[voxel] + steps[line]
            first = max(firsts[line], voxel + 1)
            while first < len(keys) and keys[first] < middle - 1:
                first += 1
            firsts[line] = other = first
            while other < len(keys) and keys[other] <= middle + 1:
                x = positions[other, 0] - positions[voxel, 0]
                y = positions[other, 1] - positions[voxel, 1]
                z = positions[other, 2] - positions[voxel, 2]
                if x * x + y * y + z * z <= limit:
                    bend = 1.0 - (
                        normals[other, 0] * normals[voxel, 0]
                        + normals[other, 1] * normals[voxel, 1]
                        + normals[other, 2] * normals[voxel, 2]
                    )
                    totals[voxel] += bend
                    totals[other] += bend
                    counts[voxel] += 1
                    counts[other] += 1
                other += 1
    spreads = np.full(len(keys), math.pi)
    for voxel in range(len(keys)):
        if counts[voxel] > 0:
            spreads[order[voxel]] = math.sqrt(max(2.0 * totals[voxel] / counts[voxel], 0.0))
    return spreads
