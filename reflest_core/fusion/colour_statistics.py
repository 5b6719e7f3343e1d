"""F and B: the mean colours of a view's foreground and background (paper, Sec. 3 and Eq. 4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, kernel_array


def foreground_background_means(
    rgb: NDArray[np.uint8], foreground: NDArray[np.bool_]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return F and B, each (3,) float32, mean 8-bit sRGB in [0, 255]; NaN where no pixel is.

    ``rgb``: (H, W, 3) uint8. ``foreground``: (H, W) bool; the background is the rest.
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
        for u in range(width):
            side = 1 if foreground[v, u] else 0
            counts[side] += 1
            for channel in range(3):
                sums[side, channel] += rgb[v, u, channel]
    return sums, counts
