# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Depth with gaps in a grid, as projection into another camera leaves it: filled within surfaces.

Depth that a driver projected into the colour camera pixel by pixel (``depth_image_proc/register``
does) is valid in some rows and columns alone. Such a gap lies within one surface where valid pixels
on opposite sides of it lie on one plane; at an edge they don't, and it stays empty.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled

STRIDE = 7
"""Rows of which one is checked for gaps."""
SPARSE = 0.08
"""Depth maps have gaps in a grid where there are so many, for each valid pixel, along the rows."""
REACH = 2
"""Pixels on each side that a gap is bridged over."""
STEP = 0.01
"""Depth on opposite sides of a gap differs by at most this share for each pixel between them."""


def fill_gaps(depth: NDArray[np.float32]) -> NDArray[np.float32]:
    """Fill gaps within surfaces where a depth map is valid in a grid alone.

    Args:
        depth: (H, W) metres, 0 where unknown.

    Returns:
        ``depth`` itself where it has no such gaps, else a filled copy.
    """
    if not has_gaps(depth):
        return depth
    filled = depth.copy()
    _fill(depth, filled)
    return filled


def has_gaps(depth: NDArray[np.float32]) -> bool:
    """Check whether rows are broken by gaps of one or two pixels far more often than by holes.

    Args:
        depth: (H, W) metres, 0 where unknown.
    """
    valid = depth[STRIDE // 2 :: STRIDE] > 0.0
    single = valid[:, :-2] & ~valid[:, 1:-1] & valid[:, 2:]
    double = valid[:, :-3] & ~valid[:, 1:-2] & ~valid[:, 2:-1] & valid[:, 3:]
    gaps = int(np.count_nonzero(single)) + int(np.count_nonzero(double))
    return gaps > SPARSE * max(int(np.count_nonzero(valid)), 1)


@compiled
def _fill(depth: NDArray[np.float32], filled: NDArray[np.float32]) -> None:
    height, width = depth.shape
    for row in range(height):
        for column in range(width):
            if depth[row, column] > 0.0:
                continue
            total, weight = 0.0, 0.0
            # Along the row, the column and both diagonals; the nearest valid pixel on each side.
            for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
                near, near_at = _first(depth, row, column, down, right)
                far, far_at = _first(depth, row, column, -down, -right)
                if near_at == 0 or far_at == 0:
                    continue
                span = near_at + far_at
                if abs(near - far) > STEP * span * min(near, far):
                    continue
                total += (near * far_at + far * near_at) / span / span
                weight += 1.0 / span
            if weight > 0.0:
                filled[row, column] = total / weight


@compiled
def _first(
    depth: NDArray[np.float32], row: int, column: int, down: int, right: int
) -> tuple[float, int]:
    """The first valid depth in a direction, and how many pixels away; 0 where there is none."""
    height, width = depth.shape
    for step in range(1, REACH + 1):
        at_row, at_column = row + step * down, column + step * right
        if not (0 <= at_row < height and 0 <= at_column < width):
            break
        if depth[at_row, at_column] > 0.0:
            return float(depth[at_row, at_column]), step
    return 0.0, 0
