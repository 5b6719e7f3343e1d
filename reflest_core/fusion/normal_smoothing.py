# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Normals averaged over neighbouring voxels of the same surface: a bilateral filter.

Noise of the depth tilts normals by one to two degrees even where a surface is flat; on a curved one
the neighbours' normals differ symmetrically, so that their mean is no less true. Normals that
differ by much belong to another surface and weigh little (Tomasi and Manduchi 1998).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.observations.observation_rows import ObservationRows
from reflest_core.jit import compiled
from reflest_core.surface.key_index import find_row
from reflest_core.surface.voxel_key import pack_key, unpack_key

DISTANCE = 0.9
"""Standard deviation of the weight by distance, in voxels."""


@compiled
def smoothed_normals(
    start: int,
    stop: int,
    rows: ObservationRows,
    selected: NDArray[np.int64],
    voxel_size: float,
    angle: float,
    smoothed: NDArray[np.float32],
) -> None:
    """Average the normals of voxels with those of the 26 voxels around each; a kernel.

    Args:
        start: First of ``selected``.
        stop: The one after the last.
        rows: The store's rows.
        selected: (S,) rows.
        voxel_size: Metres.
        angle: Standard deviation of the weight by the angle between normals, radians.
        smoothed: (S, 3) filled with unit normals.
    """
    by_distance = -0.5 / (DISTANCE * voxel_size) ** 2
    by_angle = -0.5 / angle**2
    for n in range(start, stop):
        row = selected[n]
        i, j, k = unpack_key(rows.keys[row])
        sum_x, sum_y, sum_z = 0.0, 0.0, 0.0
        for m in range(27):
            key = pack_key(i + m // 9 - 1, j + m // 3 % 3 - 1, k + m % 3 - 1)
            other = find_row(rows.index_keys, rows.index_rows, key)
            if other < 0:
                continue
            squared, cosine = 0.0, 0.0
            for axis in range(3):
                squared += (rows.positions[other, axis] - rows.positions[row, axis]) ** 2
                cosine += float(rows.normals[other, axis]) * float(rows.normals[row, axis])
            # The squared chord between unit vectors stands for the squared angle.
            weight = math.exp(by_distance * squared + by_angle * 2.0 * (1.0 - cosine))
            sum_x += weight * rows.normals[other, 0]
            sum_y += weight * rows.normals[other, 1]
            sum_z += weight * rows.normals[other, 2]
        length = math.sqrt(sum_x * sum_x + sum_y * sum_y + sum_z * sum_z)
        smoothed[n, 0], smoothed[n, 1] = sum_x / length, sum_y / length
        smoothed[n, 2] = sum_z / length
