# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Depth edges: pixels whose colour or depth may belong to another surface.

A pixel is on a depth edge if, within ``margin`` pixels of it (a square window), the depth is
unknown or differs from its own by more than :func:`depth_tolerance`. Sensors mix near and far
there, and colour and depth are seldom registered to the pixel.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled


@compiled
def depth_tolerance(z: float, voxel_size: float) -> float:
    """Return by how much two depths may differ and still be one surface; a kernel.

    Two voxels for fusion's own resolution, and 1 % of the depth for the sensor's noise and for the
    slope of a surface across a pixel.

    Args:
        z: Depth, metres.
        voxel_size: Metres.

    Returns:
        Metres.
    """
    return 2.0 * voxel_size + 0.01 * z


def clear_of_edges(depth: NDArray[np.float32], voxel_size: float, margin: int) -> NDArray[np.bool_]:
    """Find the pixels with depth that are on no depth edge.

    Args:
        depth: (H, W) metres, 0 unknown.
        voxel_size: Metres.
        margin: Pixels around an edge that count as on it.

    Returns:
        (H, W) bool.
    """
    window = np.ones((2 * margin + 1, 2 * margin + 1), np.uint8)
    nearest = np.asarray(cv2.erode(depth, window), np.float32)
    farthest = np.asarray(cv2.dilate(depth, window), np.float32)
    return _is_clear(depth, nearest, farthest, voxel_size)


@compiled
def _is_clear(
    depth: NDArray[np.float32],
    nearest: NDArray[np.float32],
    farthest: NDArray[np.float32],
    voxel_size: float,
) -> NDArray[np.bool_]:
    height, width = depth.shape
    clear = np.empty((height, width), np.bool_)
    voxel = np.float32(voxel_size)
    for v in range(height):
        for u in range(width):
            z = depth[v, u]
            tolerance = np.float32(2.0) * voxel + np.float32(0.01) * z
            clear[v, u] = (
                (nearest[v, u] > np.float32(0.0))
                & (z - nearest[v, u] <= tolerance)
                & (farthest[v, u] - z <= tolerance)
            )
    return clear
