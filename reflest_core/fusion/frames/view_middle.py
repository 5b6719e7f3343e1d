# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The surface point in the middle of a view."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame

HALF_WINDOW = 0.05
"""Of the shorter side of the image: half the edge of the square whose median depth counts."""


def view_middle(frame: Frame, max_depth: float) -> NDArray[np.float64] | None:
    """Find the surface point that the middle of an image shows.

    It lies on the ray through the centre of the image, at the median depth of a small square
    about it; where that has no depth, it is the point of the nearest pixel that has.

    Args:
        frame: the whole frame.
        max_depth: farther depth does not count, metres.

    Returns:
        (3,) world frame, metres; None where no pixel has depth.
    """
    height, width = frame.depth.shape
    half = max(round(HALF_WINDOW * min(height, width)), 1)
    row, column = height // 2, width // 2
    square = frame.depth[
        max(row - half, 0) : row + half + 1, max(column - half, 0) : column + half + 1
    ]
    near = square[_is_usable(square, max_depth)]
    if len(near):
        return _point(frame, (width - 1) / 2, (height - 1) / 2, float(np.median(near)))
    rows, columns = np.nonzero(_is_usable(frame.depth, max_depth))
    if not len(rows):
        return None
    nearest = int(np.argmin((rows - row) ** 2 + (columns - column) ** 2))
    v, u = int(rows[nearest]), int(columns[nearest])
    return _point(frame, u, v, float(frame.depth[v, u]))


def _is_usable(depth: NDArray[np.float32], max_depth: float) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(depth) & (depth > 0.0) & (depth <= max_depth))


def _point(frame: Frame, u: float, v: float, depth: float) -> NDArray[np.float64]:
    camera = frame.intrinsics
    ray = np.array([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0])
    return np.asarray(frame.T_world_camera[:3, :3] @ (depth * ray) + frame.camera_centre)
