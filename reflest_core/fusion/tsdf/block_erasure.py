# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Blocks that give way to others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.tsdf.tsdf_blocks import TsdfBlocks
from reflest_core.jit import compiled
from reflest_core.surface.key_index import drop_key, put_row
from reflest_core.surface.voxel_key import BLOCK_EDGE, pack_key, unpack_key


@compiled
def surface_keys(slots: NDArray[np.int64], blocks: TsdfBlocks) -> NDArray[np.int64]:
    """The keys of the surface voxels in the blocks ``slots``."""
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
    """Erase the blocks ``slots`` (ascending) of ``count``; return how many remain.

    The last block fills each hole, so that the blocks in use stay the first ones.
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
