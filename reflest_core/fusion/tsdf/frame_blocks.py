# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The blocks that a frame concerns: those around the surface that it shows, and others in sight."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.tsdf.tsdf_blocks import TsdfBlocks
from reflest_core.jit import compiled
from reflest_core.surface.key_index import find_row, put_row
from reflest_core.surface.voxel_key import BLOCK_EDGE, VOXEL_LIMIT, pack_key, unpack_key

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
    """Make sure of the blocks around a frame's surface and mark them as seen; a kernel.

    Args:
        depth: (H, W) metres.
        surface: (H, W) bool, what is fused.
        stride: Every so many pixels are used.
        T: (4, 4) camera to world.
        K: (3, 3) intrinsics.
        voxel_size: Metres.
        blocks: The volume's arrays.
        count: Blocks in use.
        frame_number: The frame.
        touched: (N,) filled with slots.
        touched_count: Slots that are in ``touched`` already.

    Returns:
        The new number of blocks in use, that of ``touched``, and whether some found no room;
        running it again after making room continues where it failed.
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
    """Return the stride at which no block of a surface is missed.

    A quarter of a block, because on a surface seen at a slant the samples lie further apart.

    Args:
        voxel_size: Metres.
        focal_length: Pixels.
        farthest_depth: Metres.

    Returns:
        Pixels.
    """
    return max(1, int(0.25 * BLOCK_EDGE * voxel_size * focal_length / farthest_depth))


@compiled
def blocks_in_sight(
    first: int,
    most: int,
    keys: NDArray[np.int64],
    last_seen: NDArray[np.int64],
    frame_number: int,
    P: NDArray[np.float64],
    voxel_size: float,
    width: int,
    height: int,
    reach: float,
) -> NDArray[np.int64]:
    """Find blocks that may project into the image; a kernel.

    Args:
        first: Slot from which on blocks are tested, going round at the end.
        most: Blocks that are tested at most.
        keys: (N,) block keys.
        last_seen: (N,) frame numbers.
        frame_number: Blocks marked as seen in this frame are left out.
        P: (3, 4) world to homogeneous pixels.
        voxel_size: Metres.
        width: Of the image, pixels.
        height: Of the image, pixels.
        reach: Metres of depth beyond which no block is wanted.

    Returns:
        Their slots.
    """
    count = len(keys)
    radius = 0.5 * math.sqrt(3.0) * (BLOCK_EDGE - 1) * voxel_size
    centre = 0.5 * (BLOCK_EDGE - 1) * voxel_size
    edge = BLOCK_EDGE * voxel_size
    steepest_u = math.sqrt(P[0, 0] ** 2 + P[0, 1] ** 2 + P[0, 2] ** 2)
    steepest_v = math.sqrt(P[1, 0] ** 2 + P[1, 1] ** 2 + P[1, 2] ** 2)
    found = np.empty(min(count, most), np.int64)
    found_count = 0
    for n in range(len(found)):
        slot = (first + n) % count
        if last_seen[slot] == frame_number:
            continue
        i, j, k = unpack_key(keys[slot])
        x, y, z = i * edge + centre, j * edge + centre, k * edge + centre
        ahead = P[2, 0] * x + P[2, 1] * y + P[2, 2] * z + P[2, 3]
        if ahead + radius <= 0.0 or ahead - radius > reach:
            continue
        # A pixel row or column is a plane through the camera: compare distances to the image's.
        u = P[0, 0] * x + P[0, 1] * y + P[0, 2] * z + P[0, 3]
        v = P[1, 0] * x + P[1, 1] * y + P[1, 2] * z + P[1, 3]
        across, down = (steepest_u + width) * radius, (steepest_v + height) * radius
        if u < -across or v < -down or u > width * ahead + across or v > height * ahead + down:
            continue
        found[found_count] = slot
        found_count += 1
    return found[:found_count].copy()
