# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""F and B: the mean colours of a view's foreground and background (paper, Sec. 3 and Eq. 4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, kernel_array


def foreground_background_means(
    rgb: NDArray[np.uint8], foreground: NDArray[np.bool_]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return F and B, the mean colours of foreground and background.

    Args:
        rgb: (H, W, 3) 8-bit sRGB.
        foreground: (H, W) bool; the background is the rest.

    Returns:
        F and B, each (3,) float32 in [0, 255]; NaN where no pixel is.
    """
    sums, counts = _sum_colours(kernel_array(rgb, np.uint8), kernel_array(foreground, np.bool_))
    means = np.full((2, 3), np.nan, np.float32)
    for n in range(2):
        if counts[n]:
            means[n] = sums[n] / counts[n]
    return means[1], means[0]


@compiled
def _sum_colours(
    rgb: NDArray[np.uint8], foreground: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Exact integer sums (2, 3) and counts (2,), background first."""
    sums = np.zeros((2, 3), np.int64)
    counts = np.zeros(2, np.int64)
    height, width = foreground.shape
    for v in range(height):
        # Sums of one row fit into 32 bits, and vector instructions take twice as many of those.
        inside, red, green, blue = np.uint32(0), np.uint32(0), np.uint32(0), np.uint32(0)
        all_red, all_green, all_blue = np.uint32(0), np.uint32(0), np.uint32(0)
        row, is_inside = rgb[v].reshape(3 * width), foreground[v]
        for u in range(width):
            one = np.uint32(is_inside[u])
            r = np.uint32(row[3 * u])
            g = np.uint32(row[3 * u + 1])
            b = np.uint32(row[3 * u + 2])
            inside += one
            red += r * one
            green += g * one
            blue += b * one
            all_red += r
            all_green += g
            all_blue += b
        counts[0] += width - np.int64(inside)
        counts[1] += np.int64(inside)
        for side, colours in enumerate(
            ((all_red - red, all_green - green, all_blue - blue), (red, green, blue))
        ):
            for channel in range(3):
                sums[side, channel] += np.int64(colours[channel])
    return sums, counts
