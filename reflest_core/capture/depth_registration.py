"""Depth of one camera as another camera sees it: every depth pixel's footprint, nearest first."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.jit import compiled, kernel_array

WIDEST_FOOTPRINT = 32  # pixels across; absurd calibrations would fill the image for every pixel


def register_depth(
    depth: NDArray[np.float32],
    depth_camera: CameraIntrinsics,
    T_colour_depth: NDArray[np.float64],
    colour_camera: CameraIntrinsics,
) -> NDArray[np.float32]:
    """Return depth registered to the colour camera, (H, W) float32 metres of its image size.

    ``depth``: (h, w) metres along the depth camera's axis, 0 where unknown. ``T_colour_depth``:
    (4, 4), the depth camera's optical frame in the colour camera's. A depth pixel covers what lies
    between the projections of its corners; where several cover a pixel, the nearest hides the
    others. 0 where none does.
    """
    registered = np.full((colour_camera.height, colour_camera.width), np.inf, np.float32)
    _splat(
        kernel_array(depth, np.float32),
        np.array([depth_camera.fx, depth_camera.fy, depth_camera.cx, depth_camera.cy]),
        kernel_array(T_colour_depth[:3], np.float64),
        np.array([colour_camera.fx, colour_camera.fy, colour_camera.cx, colour_camera.cy]),
        registered,
    )
    registered[np.isinf(registered)] = 0.0
    return registered


@compiled
def _splat(
    depth: NDArray[np.float32],
    depth_pinhole: NDArray[np.float64],
    transform: NDArray[np.float64],
    colour_pinhole: NDArray[np.float64],
    nearest: NDArray[np.float32],
) -> None:
    for row in range(depth.shape[0]):
        for column in range(depth.shape[1]):
            z = depth[row, column]
            if z <= 0.0:
                continue
            centre = _projected(row, column, z, depth_pinhole, transform, colour_pinhole)
            if not centre[2] > 0.0:
                continue
            first = _projected(row - 0.5, column - 0.5, z, depth_pinhole, transform, colour_pinhole)
            last = _projected(row + 0.5, column + 0.5, z, depth_pinhole, transform, colour_pinhole)
            if not (first[2] > 0.0 and last[2] > 0.0):
                continue
            left, right = _covered(first[0], last[0], centre[0], nearest.shape[1])
            top, bottom = _covered(first[1], last[1], centre[1], nearest.shape[0])
            for y in range(top, bottom):
                for x in range(left, right):
                    if centre[2] < nearest[y, x]:
                        nearest[y, x] = centre[2]


@compiled
def _projected(
    row: float,
    column: float,
    z: float,
    depth_pinhole: NDArray[np.float64],
    transform: NDArray[np.float64],
    colour_pinhole: NDArray[np.float64],
) -> tuple[float, float, float]:
    """Column, row and depth in the colour camera of a point of the depth camera."""
    px = (column - depth_pinhole[2]) / depth_pinhole[0] * z
    py = (row - depth_pinhole[3]) / depth_pinhole[1] * z
    x = transform[0, 0] * px + transform[0, 1] * py + transform[0, 2] * z + transform[0, 3]
    y = transform[1, 0] * px + transform[1, 1] * py + transform[1, 2] * z + transform[1, 3]
    depth = transform[2, 0] * px + transform[2, 1] * py + transform[2, 2] * z + transform[2, 3]
    return (
        colour_pinhole[0] * x / depth + colour_pinhole[2],
        colour_pinhole[1] * y / depth + colour_pinhole[3],
        depth,
    )


@compiled
def _covered(one: float, other: float, centre: float, size: int) -> tuple[int, int]:
    """The pixels whose centres lie in [low, high) of a footprint, inside the image."""
    low = max(min(one, other), centre - WIDEST_FOOTPRINT / 2)
    high = min(max(one, other), centre + WIDEST_FOOTPRINT / 2)
    # NaN and what lies far outside must not reach the integers.
    if not (low < size and high > 0.0):
        return 0, 0
    return max(math.ceil(low), 0), min(math.ceil(high), size)
