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
from reflest_core.jit import compiled, vectorised
from reflest_core.surface.key_index import find_row
from reflest_core.surface.voxel_key import COORDINATE_BITS

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
    by_angle = -1.0 / angle**2  # the squared chord between unit vectors stands for their angle's
    keys, positions, normals = rows.keys, rows.positions, rows.normals
    near, exponents, weights = np.empty(27, np.int64), np.empty(27), np.empty(27)
    for n in range(start, stop):
        row = selected[n]
        x, y, z = positions[row, 0], positions[row, 1], positions[row, 2]
        normal_x, normal_y, normal_z = normals[row, 0], normals[row, 1], normals[row, 2]
        count = 0
        for m in range(9):
            # A step along an axis is a sum in that coordinate's bits of the key.
            step = (m // 3 - 1) << (2 * COORDINATE_BITS)
            first = keys[row] + step + ((m % 3 - 1) << COORDINATE_BITS) - 1
            for key in range(first, first + 3):
                other = find_row(rows.index_keys, rows.index_rows, key)
                if other < 0:
                    continue
                dx, dy = positions[other, 0] - x, positions[other, 1] - y
                dz = positions[other, 2] - z
                cosine = float(normals[other, 0]) * normal_x + float(normals[other, 1]) * normal_y
                cosine += float(normals[other, 2]) * normal_z
                squared = dx * dx + dy * dy + dz * dz
                exponents[count] = by_distance * squared + by_angle * (1.0 - cosine)
                near[count] = other
                count += 1
        _exponentials(exponents[:count], weights)
        sum_x, sum_y, sum_z = 0.0, 0.0, 0.0
        for m in range(count):
            other = near[m]
            sum_x += weights[m] * normals[other, 0]
            sum_y += weights[m] * normals[other, 1]
            sum_z += weights[m] * normals[other, 2]
        if sum_x == 0.0 and sum_y == 0.0 and sum_z == 0.0:  # opposite normals cancel
            sum_x, sum_y, sum_z = float(normal_x), float(normal_y), float(normal_z)
        scale = 1.0 / math.sqrt(sum_x * sum_x + sum_y * sum_y + sum_z * sum_z)
        smoothed[n, 0], smoothed[n, 1] = sum_x * scale, sum_y * scale
        smoothed[n, 2] = sum_z * scale


@vectorised
def _exponentials(exponents: NDArray[np.float64], values: NDArray[np.float64]) -> None:
    """Exponentials of numbers up to 0, to 1e-10; vector instructions know none.

    Six squarings of the power series at a 64th; below -40 the value is negligible.
    """
    for n in range(len(exponents)):
        x = max(exponents[n], -40.0) * (1.0 / 64.0)
        value = 1.0 / 24.0 + x * (1.0 / 120.0 + x * (1.0 / 720.0))
        value = 1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x * value)))
        value *= value
        value *= value
        value *= value
        value *= value
        value *= value
        values[n] = value * value
