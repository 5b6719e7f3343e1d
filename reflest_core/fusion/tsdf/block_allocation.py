# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which blocks a frame needs: those near the surface that its depth shows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.tsdf.tsdf_blocks import TsdfBlocks
from reflest_core.jit import compiled
from reflest_core.surface.key_index import find_row, put_row
from reflest_core.surface.voxel_key import BLOCK_EDGE, VOXEL_LIMIT, pack_key

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
    touched: NDArray[np.int64],
    touched_count: int,
) -> tuple[int, int, bool]:
    """Make sure of the blocks around every ``stride``-th surface pixel and mark them as seen.

    ``T``: (4, 4) camera to world. ``K``: (3, 3). Slots are appended to ``touched``. Returns the new
    count of blocks, that of ``touched``, and whether some found no room; running it again after
    making room continues where it failed.
    """
    height, width = depth.shape
    margin = SURFACE_MARGIN / BLOCK_EDGE
    limit = VOXEL_LIMIT // BLOCK_EDGE
    A = T / (voxel_size * BLOCK_EDGE)
    is_full = False
    i0, j0, k0, i1, j1, k1 = 0, 0, 0, -1, -1, -1
    for v in range(0, height, stride):
        b = (v - K[1, 2]) / K[1, 1]
        for u in range(0, width, stride):
            if not surface[v, u]:
                continue
            a = (u - K[0, 2]) / K[0, 0]
            z = np.float64(depth[v, u])
            x = (A[0, 0] * a + A[0, 1] * b + A[0, 2]) * z + A[0, 3] + 0.5 / BLOCK_EDGE
            y = (A[1, 0] * a + A[1, 1] * b + A[1, 2]) * z + A[1, 3] + 0.5 / BLOCK_EDGE
            w = (A[2, 0] * a + A[2, 1] * b + A[2, 2]) * z + A[2, 3] + 0.5 / BLOCK_EDGE
            if max(abs(x), abs(y), abs(w)) > limit - 2:
                continue
            il, jl, kl = (
                int(np.floor(x - margin)),
                int(np.floor(y - margin)),
                int(np.floor(w - margin)),
            )
            ih, jh, kh = (
                int(np.floor(x + margin)),
                int(np.floor(y + margin)),
                int(np.floor(w + margin)),
            )
            if il == i0 and jl == j0 and kl == k0 and ih == i1 and jh == j1 and kh == k1:
                continue
            i0, j0, k0, i1, j1, k1 = il, jl, kl, ih, jh, kh
            for i in range(i0, i1 + 1):
                for j in range(j0, j1 + 1):
                    for k in range(k0, k1 + 1):
                        key = pack_key(i, j, k)
                        slot = find_row(blocks.index_keys, blocks.index_rows, key)
                        if slot < 0:
                            if count == len(blocks.keys):
                                is_full = True
                                continue
                            slot = count
                            count += 1
                            _open_block(blocks, key, slot)
                        if blocks.last_seen[slot] != frame_number:
                            blocks.last_seen[slot] = frame_number
                            touched[touched_count] = slot
                            touched_count += 1
    return count, touched_count, is_full


@compiled
def _open_block(blocks: TsdfBlocks, key: int, slot: int) -> None:
    """Start an unobserved block."""
    put_row(blocks.index_keys, blocks.index_rows, key, slot)
    blocks.keys[slot] = key
    blocks.tsdf[slot] = 1.0
    blocks.weight[slot] = 0
    blocks.on_surface[slot] = False
    blocks.last_seen[slot] = 0


def pixel_stride(voxel_size: float, focal_length: float, farthest_depth: float) -> int:
    """The pixel stride that is a quarter of a block at ``farthest_depth`` (metres).

    A quarter, because on a surface seen at a slant the samples lie further apart.
    """
    return max(1, int(0.25 * BLOCK_EDGE * voxel_size * focal_length / farthest_depth))
