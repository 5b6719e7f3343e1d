# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The arrays of a block-hashed TSDF, and how blocks are erased from them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.key_index import drop_key, put_row
from reflest_core.surface.voxel_key import BLOCK_EDGE, pack_key, unpack_key


class TsdfBlocks(NamedTuple):
    """N blocks of 8 x 8 x 8 voxels, as kernels take them.

    Attributes:
        index_keys: (S,) int64, slots of the :class:`.KeyIndex` from block key to row.
        index_rows: (S,) int32, the same.
        keys: (N,) int64 block keys.
        tsdf: (N, 8, 8, 8) float32, distance over truncation in [-1, 1], positive outside.
        weight: (N, 8, 8, 8) uint16, 0 unobserved.
        on_surface: (N, 8, 8, 8) bool, surface voxels when the block was extracted last.
        last_seen: (N,) int64, frame number.
    """

    index_keys: NDArray[np.int64]
    index_rows: NDArray[np.int32]
    keys: NDArray[np.int64]
    tsdf: NDArray[np.float32]
    weight: NDArray[np.uint16]
    on_surface: NDArray[np.bool_]
    last_seen: NDArray[np.int64]


@compiled
def surface_keys(slots: NDArray[np.int64], blocks: TsdfBlocks) -> NDArray[np.int64]:
    """List the surface voxels of blocks; a kernel.

    Args:
        slots: Blocks.
        blocks: The volume's arrays.

    Returns:
        Voxel keys.
    """
    found = np.empty(len(slots) * BLOCK_EDGE**3, np.int64)
    count = 0
    for slot in slots:
        i, j, k = unpack_key(blocks.keys[slot])
        for a in range(BLOCK_EDGE):
            for b in range(BLOCK_EDGE):
                for c in range(BLOCK_EDGE):
                    if blocks.on_surface[slot, a, b, c]:
                        found[count] = pack_key(
                            i * BLOCK_EDGE + a, j * BLOCK_EDGE + b, k * BLOCK_EDGE + c
                        )
                        count += 1
    return found[:count].copy()


@compiled
def erase_blocks(slots: NDArray[np.int64], blocks: TsdfBlocks, count: int) -> int:
    """Erase blocks; a kernel.

    The last block fills each hole, so that the blocks in use stay the first ones.

    Args:
        slots: Blocks, ascending.
        blocks: The volume's arrays.
        count: Blocks in use.

    Returns:
        How many remain.
    """
    for slot in slots[::-1]:
        drop_key(blocks.index_keys, blocks.index_rows, blocks.keys[slot])
        count -= 1
        if slot != count:
            blocks.keys[slot] = blocks.keys[count]
            blocks.tsdf[slot] = blocks.tsdf[count]
            blocks.weight[slot] = blocks.weight[count]
            blocks.on_surface[slot] = blocks.on_surface[count]
            blocks.last_seen[slot] = blocks.last_seen[count]
            put_row(blocks.index_keys, blocks.index_rows, blocks.keys[slot], slot)
    return count
