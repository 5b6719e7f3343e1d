# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Depth of one camera as another camera sees it: every depth pixel's footprint, nearest first."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.jit import compiled, kernel_array

REACH = 16.0  # pixels around its centre that a footprint may cover; absurd calibrations ask for all


def register_depth(
    depth: NDArray[np.float32],
    depth_camera: CameraIntrinsics,
    T_colour_depth: NDArray[np.float64],
    colour_camera: CameraIntrinsics,
) -> NDArray[np.float32]:
    """Register depth to another camera.

    A depth pixel covers the upright box around its projected corners; where several cover a pixel,
    the nearest hides the others.

    Args:
        depth: (h, w) float32, metres along the depth camera's axis, 0 where unknown.
        depth_camera: Intrinsics of the depth image.
        T_colour_depth: (4, 4) the depth camera's optical frame in the colour camera's.
        colour_camera: Intrinsics of the colour image.

    Returns:
        (H, W) float32 metres, of the colour image's size; 0 where no depth pixel falls.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        turned = colour_camera.matrix @ T_colour_depth[:3, :3] @ np.linalg.inv(depth_camera.matrix)
        shift = colour_camera.matrix @ T_colour_depth[:3, 3]
    registered = np.full((colour_camera.height, colour_camera.width), np.inf, np.float32)
    _splat(
        kernel_array(depth, np.float32),
        kernel_array(turned, np.float64),
        kernel_array(shift, np.float64),
        registered,
    )
    registered[np.isinf(registered)] = 0.0
    return registered


def along_axis(depth: NDArray[np.float32], camera: CameraIntrinsics) -> NDArray[np.float32]:
    """Turn distances from the camera centre into depth.

    Args:
        depth: (H, W) metres along each pixel's ray.
        camera: The rectified camera.

    Returns:
        (H, W) float32 metres along the optical axis.
    """
    rows, columns = np.ogrid[: camera.height, : camera.width]
    across, down = (columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy
    return (depth / np.sqrt(1.0 + across**2 + down**2)).astype(np.float32)


@compiled
def _splat(
    depth: NDArray[np.float32],
    turned: NDArray[np.float64],
    shift: NDArray[np.float64],
    nearest: NDArray[np.float32],
) -> None:
    """Project with ``turned`` (3, 3) and ``shift`` (3,): z turned (u, v, 1) + shift."""
    height, width = nearest.shape
    for row in range(depth.shape[0]):
        for column in range(depth.shape[1]):
            z = np.float64(depth[row, column])
            if z <= 0.0:
                continue
            across = z * (turned[0, 0] * column + turned[0, 1] * row + turned[0, 2]) + shift[0]
            down = z * (turned[1, 0] * column + turned[1, 1] * row + turned[1, 2]) + shift[1]
            away = z * (turned[2, 0] * column + turned[2, 1] * row + turned[2, 2]) + shift[2]
            if not away > 0.0:
                continue
            x, y = across / away, down / away
            # Written so that NaN, too, is left out.
            if not (-REACH < x < width + REACH and -REACH < y < height + REACH):
                continue
            left, right, top, bottom = x, x, y, y
            for corner in range(4):
                along, below = 0.5 * z * (2 * (corner % 2) - 1), 0.5 * z * (2 * (corner // 2) - 1)
                corner_away = away + turned[2, 0] * along + turned[2, 1] * below
                if not corner_away > 0.0:
                    continue
                corner_x = (across + turned[0, 0] * along + turned[0, 1] * below) / corner_away
                corner_y = (down + turned[1, 0] * along + turned[1, 1] * below) / corner_away
                left, right = min(corner_x, left), max(corner_x, right)
                top, bottom = min(corner_y, top), max(corner_y, bottom)
            for there_y in range(_first(top, y), _end(bottom, y, height)):
                for there_x in range(_first(left, x), _end(right, x, width)):
                    if away < nearest[there_y, there_x]:
                        nearest[there_y, there_x] = away


@compiled
def _first(low: float, centre: float) -> int:
    """The first pixel whose centre is not before ``low``."""
    return max(math.ceil(max(low, centre - REACH)), 0)


@compiled
def _end(high: float, centre: float, size: int) -> int:
    """One past the last pixel whose centre is before ``high``."""
    return min(math.ceil(min(high, centre + REACH)), size)
