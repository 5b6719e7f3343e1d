# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The projection of a block's voxels into an image.

Written as plain loops over the 512 voxels without branches, which the compiler turns into vector
instructions; single precision from the block's corner, whose place is computed in double.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.voxel_key import BLOCK_EDGE, unpack_key

VOXELS = BLOCK_EDGE**3
"""Voxels of a block; their order is that of the block's arrays."""


class BlockProjection(NamedTuple):
    """Where every voxel of one block projects to.

    Attributes:
        z: (512,) float32, metres along the optical axis.
        is_inside: (512,) whether the voxel is in front of the camera and projects into the image;
            the rest holds for these alone.
        nearest: (512,) int32, flat index of the nearest pixel.
        corner: (512,) int32, flat index of the upper left of the four pixels around it.
        right: (512,) float32 in [0, 1], where it is between these four.
        down: (512,) float32 in [0, 1], the same.
    """

    z: NDArray[np.float32]
    is_inside: NDArray[np.bool_]
    nearest: NDArray[np.int32]
    corner: NDArray[np.int32]
    right: NDArray[np.float32]
    down: NDArray[np.float32]


@compiled
def empty_projection() -> BlockProjection:
    """Reserve room for one block's projection; a kernel.

    Returns:
        Arrays to fill.
    """
    return BlockProjection(
        np.empty(VOXELS, np.float32),
        np.empty(VOXELS, np.bool_),
        np.empty(VOXELS, np.int32),
        np.empty(VOXELS, np.int32),
        np.empty(VOXELS, np.float32),
        np.empty(VOXELS, np.float32),
    )


@compiled
def project_block(
    key: int,
    P: NDArray[np.float64],
    voxel_size: float,
    height: int,
    width: int,
    out: BlockProjection,
) -> None:
    """Project a block; a kernel.

    Args:
        key: The block.
        P: (3, 4) world to homogeneous pixels.
        voxel_size: Metres.
        height: Of the image, pixels.
        width: Of the image, pixels.
        out: Filled.
    """
    i, j, k = unpack_key(key)
    x, y, z = np.float64(i * BLOCK_EDGE), np.float64(j * BLOCK_EDGE), np.float64(k * BLOCK_EDGE)
    at = np.empty(3, np.float32)
    for row in range(3):
        at[row] = (P[row, 0] * x + P[row, 1] * y + P[row, 2] * z) * voxel_size + P[row, 3]
    step = (P[:, :3] * voxel_size).astype(np.float32)
    zero, half, one = np.float32(0.0), np.float32(0.5), np.float32(1.0)
    last_u, last_v = np.float32(width) - half, np.float32(height) - half
    stride, last_column, last_row = np.int32(width), np.int32(width - 2), np.int32(height - 2)
    for n in range(VOXELS):
        a = np.float32(n // BLOCK_EDGE**2)
        b = np.float32(n // BLOCK_EDGE % BLOCK_EDGE)
        c = np.float32(n % BLOCK_EDGE)
        ahead = at[2] + a * step[2, 0] + b * step[2, 1] + c * step[2, 2]
        inverse = one / ahead
        u = (at[0] + a * step[0, 0] + b * step[0, 1] + c * step[0, 2]) * inverse
        v = (at[1] + a * step[1, 0] + b * step[1, 1] + c * step[1, 2]) * inverse
        is_inside = (ahead > zero) & (u >= -half) & (u < last_u) & (v >= -half) & (v < last_v)
        u = u if is_inside else zero
        v = v if is_inside else zero
        out.z[n] = ahead
        out.is_inside[n] = is_inside
        out.nearest[n] = np.int32(v + half) * stride + np.int32(u + half)
        u, v = max(u, zero), max(v, zero)
        column, row_ = min(np.int32(u), last_column), min(np.int32(v), last_row)
        out.corner[n] = row_ * stride + column
        out.right[n] = min(u - np.float32(column), one)
        out.down[n] = min(v - np.float32(row_), one)
