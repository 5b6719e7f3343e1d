# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Voxels and blocks by integer coordinates, packed into one key.

Voxel ``(i, j, k)`` has its sample point at ``(i, j, k) * voxel_size`` in the world frame (as in
Open3D's VoxelBlockGrid) and its cell is the cube of that size around the sample point. Block ``(i,
j, k)`` holds the voxels ``8 * (i, j, k) + (0..7)`` along each axis.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled

BLOCK_EDGE = 8
"""Voxels along a block's edge."""

NO_KEY = 0
"""No voxel packs to this key."""

VOXEL_LIMIT = (1 << 20) - 2 * BLOCK_EDGE
"""Voxel coordinates lie strictly between minus and plus this (5 km either way at 5 mm)."""

COORDINATE_BITS = 21
"""Bits of a key that each coordinate takes, the last one the lowest."""

_OFFSET = 1 << (COORDINATE_BITS - 1)
_MASK = (1 << COORDINATE_BITS) - 1


def key_coordinates(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Unpack many keys, as :func:`unpack_key` does one.

    Args:
        keys: (N,) keys of voxels or blocks.

    Returns:
        (N, 3) i, j, k.
    """
    shifts = np.array([2 * COORDINATE_BITS, COORDINATE_BITS, 0])
    return np.asarray(((keys[:, None] >> shifts) & _MASK) - _OFFSET)


@compiled
def pack_key(i: int, j: int, k: int) -> int:
    """Pack coordinates within ``VOXEL_LIMIT`` into a key; keys order as (i, j, k) do. A kernel.

    Args:
        i: Along x.
        j: Along y.
        k: Along z.

    Returns:
        A positive key.
    """
    return (
        ((i + _OFFSET) << (2 * COORDINATE_BITS))
        | ((j + _OFFSET) << COORDINATE_BITS)
        | (k + _OFFSET)
    )


@compiled
def unpack_key(key: int) -> tuple[int, int, int]:
    """Invert :func:`pack_key`; a kernel.

    Args:
        key: A key.

    Returns:
        i, j, k.
    """
    return (
        ((key >> (2 * COORDINATE_BITS)) & _MASK) - _OFFSET,
        ((key >> COORDINATE_BITS) & _MASK) - _OFFSET,
        (key & _MASK) - _OFFSET,
    )
