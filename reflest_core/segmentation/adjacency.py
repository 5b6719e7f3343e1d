# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which voxels are neighbours: all pairs within a radius, by a hash of cells of that size."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, kernel_array
from reflest_core.surface.key_index import KeyIndex, find_row
from reflest_core.surface.observed_surface import NEIGHBOUR_RADIUS
from reflest_core.surface.voxel_key import pack_key, unpack_key


def neighbour_pairs(
    positions: NDArray[np.float32], radius: float = NEIGHBOUR_RADIUS
) -> NDArray[np.int32]:
    """Find all pairs of voxels that are at most ``radius`` apart.

    Args:
        positions: (V, 3) metres.
        radius: metres; the scan may extend over a million radii.

    Returns:
        (E, 2) indices with ``pair[0] < pair[1]``, by rising first index.
    """
    if len(positions) < 2:
        return np.zeros((0, 2), np.int32)
    cells = np.floor(positions / np.float32(radius)).astype(np.int64)
    cells -= cells.min(axis=0)
    keys = _packed(cells)
    members = np.argsort(keys, kind="stable").astype(np.int32)
    cell_keys, firsts = np.unique(keys[members], return_index=True)
    index_of_cell = np.searchsorted(cell_keys, keys)
    index = KeyIndex(len(cell_keys))
    index.fill(cell_keys)
    bounds = np.append(firsts, len(keys)).astype(np.int64)
    return _pairs(
        kernel_array(positions, np.float32),
        _cells_around(cell_keys, index.keys, index.rows),
        index_of_cell,
        members,
        bounds,
        radius * radius,
    )


@compiled
def _packed(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    keys = np.empty(len(cells), np.int64)
    for voxel in range(len(cells)):
        keys[voxel] = pack_key(cells[voxel, 0], cells[voxel, 1], cells[voxel, 2])
    return keys


@compiled
def _cells_around(
    cell_keys: NDArray[np.int64], slot_keys: NDArray[np.int64], slot_rows: NDArray[np.int32]
) -> NDArray[np.int32]:
    """(C, 27) the cells around each, itself included; -1 where there is none."""
    around = np.empty((len(cell_keys), 27), np.int32)
    for cell in range(len(cell_keys)):
        i, j, k = unpack_key(cell_keys[cell])
        for n in range(27):
            key = pack_key(i + n // 9 - 1, j + n // 3 % 3 - 1, k + n % 3 - 1)
            around[cell, n] = find_row(slot_keys, slot_rows, key)
    return around


@compiled
def _pairs(
    positions: NDArray[np.float32],
    around: NDArray[np.int32],
    cell_of: NDArray[np.int64],
    members: NDArray[np.int32],
    bounds: NDArray[np.int64],
    square: float,
) -> NDArray[np.int32]:
    found, count = np.empty((8 * len(positions), 2), np.int32), 0
    for voxel in range(len(positions)):
        x, y, z = positions[voxel, 0], positions[voxel, 1], positions[voxel, 2]
        for n in range(27):
            cell = around[cell_of[voxel], n]
            if cell < 0:
                continue
            for slot in range(bounds[cell], bounds[cell + 1]):
                other = members[slot]
                if other <= voxel:
                    continue
                dx = positions[other, 0] - x
                dy = positions[other, 1] - y
                dz = positions[other, 2] - z
                if dx * dx + dy * dy + dz * dz > square:
                    continue
                if count == len(found):
                    larger = np.empty((2 * len(found), 2), np.int32)
                    larger[:count] = found
                    found = larger
                found[count, 0], found[count, 1] = voxel, other
                count += 1
    return found[:count].copy()
