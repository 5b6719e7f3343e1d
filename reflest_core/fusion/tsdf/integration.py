# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Depth into the truncated signed distance function (Curless & Levoy 1996; paper, Sec. 3.1).

Each voxel keeps the weighted mean of its distance to the tangent plane at the pixel it projects to,
cut off at the truncation distance (plain projective distances are too long by the slant, which
bends the level set where views differ). Only the foreground's clear pixels move a surface. Other
depth just says that the space in front of it is free, which clears what noise and movement left
behind; near a silhouette it says nothing, for there the true distance is unknown but small.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.frames.slant import FULL_WEIGHT
from reflest_core.fusion.tsdf.block_projection import (
    VOXELS,
    BlockProjection,
    empty_projection,
    project_block,
)
from reflest_core.fusion.tsdf.tsdf_blocks import TsdfBlocks
from reflest_core.jit import compiled

MAX_WEIGHT = 256 * FULL_WEIGHT
"""After this the mean slides, so that a moved surface is still followed."""


@compiled
def integrate_blocks(
    start: int,
    stop: int,
    slots: NDArray[np.int64],
    depth: NDArray[np.float32],
    steepness: NDArray[np.float32],
    gain: NDArray[np.uint8],
    free_depth: NDArray[np.float32],
    P: NDArray[np.float64],
    voxel_size: float,
    truncation: float,
    blocks: TsdfBlocks,
    frame_number: int,
) -> NDArray[np.int64]:
    """Fuse a frame's depth into blocks; a kernel.

    Args:
        start: First of ``slots``.
        stop: The one after the last.
        slots: Blocks.
        depth: (H, W) metres, see :class:`.FramePixels`.
        steepness: (H, W) the same.
        gain: (H, W) the same.
        free_depth: (H, W) the same.
        P: (3, 4) world to homogeneous pixels.
        voxel_size: Metres.
        truncation: Metres.
        blocks: The volume's arrays.
        frame_number: The frame.

    Returns:
        Those of ``slots[start:stop]`` that changed, in their order.
    """
    height, width = depth.shape
    projection = empty_projection()
    surface_z = np.empty(VOXELS, np.float32)
    pixel_steepness = np.empty(VOXELS, np.float32)
    pixel_gain = np.empty(VOXELS, np.float32)
    pixel_free = np.empty(VOXELS, np.float32)
    changed = np.empty(stop - start, np.int64)
    count = 0
    for n in range(start, stop):
        slot = slots[n]
        project_block(blocks.keys[slot], P, voxel_size, height, width, projection)
        if not np.any(projection.is_inside):
            continue
        _interpolate(depth.reshape(-1), width, projection, surface_z)
        _look_up(
            steepness.reshape(-1),
            gain.reshape(-1),
            free_depth.reshape(-1),
            projection.nearest,
            pixel_steepness,
            pixel_gain,
            pixel_free,
        )
        if _update(
            projection,
            surface_z,
            pixel_steepness,
            pixel_gain,
            pixel_free,
            np.float32(truncation),
            blocks.tsdf[slot].reshape(VOXELS),
            blocks.weight[slot].reshape(VOXELS),
        ):
            blocks.last_seen[slot] = frame_number
            changed[count] = slot
            count += 1
    return changed[:count].copy()


@compiled
def _interpolate(
    depth: NDArray[np.float32], width: int, at: BlockProjection, found: NDArray[np.float32]
) -> None:
    """Bilinear depth; to be believed at pixels clear of depth edges alone.

    Clear means that the neighbours have depth of the same surface, so that they may be mixed.
    """
    below = np.uint32(width)
    for n in range(VOXELS):
        k = np.uint32(at.corner[n])
        one = np.uint32(1)
        top = depth[k] + at.right[n] * (depth[k + one] - depth[k])
        k += below
        bottom = depth[k] + at.right[n] * (depth[k + one] - depth[k])
        found[n] = top + at.down[n] * (bottom - top)


@compiled
def _look_up(
    steepness: NDArray[np.float32],
    gain: NDArray[np.uint8],
    free_depth: NDArray[np.float32],
    nearest: NDArray[np.int32],
    pixel_steepness: NDArray[np.float32],
    pixel_gain: NDArray[np.float32],
    pixel_free: NDArray[np.float32],
) -> None:
    for n in range(VOXELS):
        k = np.uint32(nearest[n])
        pixel_steepness[n] = steepness[k]
        pixel_gain[n] = np.float32(gain[k])
        pixel_free[n] = free_depth[k]


@compiled
def _update(
    at: BlockProjection,
    surface_z: NDArray[np.float32],
    pixel_steepness: NDArray[np.float32],
    pixel_gain: NDArray[np.float32],
    pixel_free: NDArray[np.float32],
    truncation: np.float32,
    tsdf: NDArray[np.float32],
    weight: NDArray[np.uint16],
) -> bool:
    zero, one = np.float32(0.0), np.float32(1.0)
    full, most = np.float32(FULL_WEIGHT), np.float32(MAX_WEIGHT)
    changes = np.int32(0)
    for n in range(VOXELS):
        ahead = surface_z[n] - at.z[n]
        is_surface = pixel_steepness[n] > zero
        value = min(one, ahead / truncation * pixel_steepness[n]) if is_surface else one
        is_behind = is_surface & (ahead < -truncation)
        is_far_ahead = value == one
        is_free = pixel_free[n] - at.z[n] >= truncation
        added = full if is_far_ahead else pixel_gain[n]
        is_measured = at.is_inside[n] & (not is_behind) & (is_free | (not is_far_ahead))
        added = added if is_measured else zero
        total = np.float32(weight[n]) + added
        tsdf[n] += (value - tsdf[n]) * (added / max(total, one))
        weight[n] = np.uint16(np.int32(min(total, most)))
        changes |= np.int32(added > zero)
    return bool(changes != 0)
