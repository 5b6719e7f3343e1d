# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which parts of a surface a later depth map contradicts, as after a jump of the tracker."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.poses.agreement import GROWTH, RELATIVE_TOLERANCE, TOLERANCE
from reflest_core.surface.voxel_key import BLOCK_EDGE, COORDINATE_BITS

FACING = 0.3
"""Least cosine between a voxel's normal and the direction to the camera for it to be judged."""
GHOST = 0.15
"""Metres behind what is seen now within which a surface that faces the camera is taken for the
same surface at its old place; farther behind it may be another one, hidden."""
CONTRADICTED = 0.3
"""A block of voxels is contradicted where more than this share of those that were judged is."""


def contradicted_blocks(
    keys: NDArray[np.int64],
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    frame: Frame,
) -> NDArray[np.int64]:
    """Find the blocks whose surface is not where a depth map shows it.

    Args:
        keys: (V,) int64, packed keys of surface voxels.
        positions: (V, 3) metres, in the frame's world.
        normals: (V, 3) unit, outward.
        frame: a later frame.

    Returns:
        (B,) int64, packed keys of blocks, rising.
    """
    voxels, depth, away = _in_sight(positions, normals, frame)
    growth = np.where(depth > 1.0, depth**GROWTH, 1.0)
    tolerance = np.minimum(TOLERANCE * growth, RELATIVE_TOLERANCE * depth)
    behind = away - depth
    is_judged = behind < GHOST
    is_contradicted = is_judged & (np.abs(behind) > tolerance)
    blocks, block_of = np.unique(_block_keys(keys[voxels]), return_inverse=True)
    judged = np.bincount(block_of, is_judged, len(blocks))
    contradicted = np.bincount(block_of, is_contradicted, len(blocks))
    return blocks[contradicted > CONTRADICTED * judged]


def _in_sight(
    positions: NDArray[np.float32], normals: NDArray[np.float32], frame: Frame
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Voxels that face the camera where there is depth: indices, that depth, and their own."""
    camera, pose = frame.intrinsics, frame.T_world_camera
    from_camera = positions.astype(np.float64) - frame.camera_centre
    facing = -np.einsum("ij,ij->i", from_camera, normals.astype(np.float64))
    x, y, z = (from_camera @ pose[:3, :3]).T
    is_candidate = (z > 0.0) & (facing > FACING * np.linalg.norm(from_camera, axis=1))
    voxels = np.flatnonzero(is_candidate)
    column = np.round(camera.fx * x[voxels] / z[voxels] + camera.cx)
    row = np.round(camera.fy * y[voxels] / z[voxels] + camera.cy)
    is_inside = (column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height)
    voxels, column, row = voxels[is_inside], column[is_inside], row[is_inside]
    depth = frame.depth[row.astype(np.int64), column.astype(np.int64)].astype(np.float64)
    is_known = np.isfinite(depth) & (depth > 0.0)
    return voxels[is_known], depth[is_known], z[voxels[is_known]]


def _block_keys(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """The packed key of the block that each voxel lies in."""
    mask, offset = (1 << COORDINATE_BITS) - 1, 1 << (COORDINATE_BITS - 1)
    packed = np.zeros_like(keys)
    for shift in (2 * COORDINATE_BITS, COORDINATE_BITS, 0):
        coordinate = ((keys >> shift) & mask) - offset
        packed |= (coordinate // BLOCK_EDGE + offset) << shift
    return packed
