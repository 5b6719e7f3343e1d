"""Which blocks a frame needs: those near the surface that its depth shows."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.key_index import find_row, put_row
from reflest_core.fusion.tsdf_blocks import TsdfBlocks
from reflest_core.fusion.voxel_key import BLOCK_EDGE, VOXEL_LIMIT, pack_key
from reflest_core.jit import compiled

SURFACE_MARGIN = 2.0
"""Voxels around a measured point whose blocks are needed, for gradients at the zero level."""


@compiled
def allocate_blocks(
    depth: NDArray[np.float32],
    surface: NDArray[np.bool_],
    stride: int,
    T: NDArray[np.float64],
    K: NDArray[np.float64],
    voxel_size: float,
    blocks: TsdfBlocks,
    count: int,
    frame_number: int,
) -> tuple[int, bool]:
    """Make sure of the blocks around every ``stride``-th surface pixel and mark them as seen.

    ``T``: (4, 4) camera to world. ``K``: (3, 3). Returns the new count of blocks and whether some
    found no room; running it again after making room continues where it failed.
    """
    height, width = depth.shape
    block_size = voxel_size * BLOCK_EDGE
    margin = SURFACE_MARGIN * voxel_size
    limit = VOXEL_LIMIT // BLOCK_EDGE
    low = np.zeros(3, np.int64)
    high = np.zeros(3, np.int64)
    last_low = np.full(3, limit, np.int64)
    last_high = np.full(3, limit, np.int64)
    is_full = False
    for v in range(0, height, stride):
        for u in range(0, width, stride):
            if not surface[v, u]:
                continue
            z = float(depth[v, u])
            x, y = (u - K[0, 2]) / K[0, 0] * z, (v - K[1, 2]) / K[1, 1] * z
            is_new, is_inside = False, True
            for axis in range(3):
                world = T[axis, 0] * x + T[axis, 1] * y + T[axis, 2] * z + T[axis, 3]
                low[axis] = math.floor((world - margin) / block_size + 0.5 / BLOCK_EDGE)
                high[axis] = math.floor((world + margin) / block_size + 0.5 / BLOCK_EDGE)
                is_inside &= low[axis] > -limit and high[axis] < limit
                is_new |= low[axis] != last_low[axis] or high[axis] != last_high[axis]
            if not (is_new and is_inside):
                continue
            last_low[:] = low
            last_high[:] = high
            for i in range(low[0], high[0] + 1):
                for j in range(low[1], high[1] + 1):
                    for k in range(low[2], high[2] + 1):
                        key = pack_key(i, j, k)
                        slot = find_row(blocks.index_keys, blocks.index_rows, key)
                        if slot < 0:
                            if count == len(blocks.keys):
                                is_full = True
                                continue
                            slot = count
                            count += 1
                            put_row(blocks.index_keys, blocks.index_rows, key, slot)
                            blocks.keys[slot] = key
                            blocks.tsdf[slot] = 1.0
                            blocks.weight[slot] = 0
                            blocks.on_surface[slot] = False
                        blocks.last_seen[slot] = frame_number
    return count, is_full


def pixel_stride(voxel_size: float, focal_length: float, farthest_depth: float) -> int:
    """The pixel stride that is a quarter of a block at ``farthest_depth`` (metres).

    A quarter, because on a surface seen at a slant the samples lie further apart.
    """
    return max(1, int(0.25 * BLOCK_EDGE * voxel_size * focal_length / farthest_depth))
