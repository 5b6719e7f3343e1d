"""Depth edges: pixels whose colour or depth may belong to another surface.

A pixel is on a depth edge if, within ``margin`` pixels of it (a square window), the depth is
unknown or differs from its own by more than :func:`depth_tolerance`. Sensors mix near and far
there, and colour and depth are seldom registered to the pixel.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.jit import compiled

TOLERANCE_VOXELS = 2.0
"""Share of the depth tolerance for fusion's own resolution, in voxels."""

TOLERANCE_SHARE = 0.01
"""Share for the sensor's noise and a surface's slope across a pixel, as a fraction of depth."""


@compiled
def depth_tolerance(z: float, voxel_size: float) -> float:
    """Metres by which two depths near ``z`` may differ and still be one surface."""
    return TOLERANCE_VOXELS * voxel_size + TOLERANCE_SHARE * z


def clear_of_edges(depth: NDArray[np.float32], voxel_size: float, margin: int) -> NDArray[np.bool_]:
    """(H, W) bool: where depth is known and on no depth edge. ``depth``: metres, 0 unknown."""
    window = np.ones((2 * margin + 1, 2 * margin + 1), np.uint8)
    nearest = cv2.erode(depth, window)
    farthest = cv2.dilate(depth, window)
    tolerance = TOLERANCE_VOXELS * voxel_size + TOLERANCE_SHARE * depth
    clear: NDArray[np.bool_] = (
        (nearest > 0.0) & (depth - nearest <= tolerance) & (farthest - depth <= tolerance)
    )
    return clear
