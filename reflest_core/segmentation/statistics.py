# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Per-voxel quantiles of colour over the views."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.jit import compiled

QUANTILES = (0.15, 0.5, 0.85)
"""Low: without highlights, but not the minimum, which noise and occlusion lower; median; high."""
MOST_OBSERVATIONS = 64
"""Observations used of one voxel, taken evenly over the order in which they were made."""
DARK = 0.01
"""Linear radiance added to both sides of a contrast, so that noise in the dark has none."""


@dataclass(frozen=True)
class VoxelColours:
    """Quantiles of each voxel's linear colour over its views.

    Attributes:
        low: (V, 3) float32, the 15 % quantile of each channel; 1 means clipped.
        median: (V, 3) float32.
        high: (V, 3) float32, the 85 % quantile.
    """

    low: NDArray[np.float32]
    median: NDArray[np.float32]
    high: NDArray[np.float32]

    @property
    def contrast(self) -> NDArray[np.float32]:
        """(V,) natural logarithm of bright over dark views: glossy voxels vary most."""
        bright, dark = self.high.mean(axis=1), self.low.mean(axis=1)
        return np.asarray(np.log((bright + DARK) / (dark + DARK)), np.float32)

    def of(self, voxels: NDArray[np.int64]) -> VoxelColours:
        """Select voxels.

        Args:
            voxels: (N,) indices.
        """
        return VoxelColours(self.low[voxels], self.median[voxels], self.high[voxels])


def voxel_colours(colours: NDArray[np.uint8], offsets: NDArray[np.int64]) -> VoxelColours:
    """Compute the quantiles of every voxel.

    Args:
        colours: (O, 3) 8-bit sRGB observations, grouped by voxel.
        offsets: (V + 1,) voxel k owns observations ``offsets[k]:offsets[k + 1]``.

    Returns:
        The quantiles; 0 for a voxel without observations.
    """
    eight_bit = _quantiles(colours, offsets, np.array(QUANTILES))
    low, median, high = srgb.LINEAR[eight_bit]
    return VoxelColours(low, median, high)


@compiled
def _quantiles(
    colours: NDArray[np.uint8], offsets: NDArray[np.int64], quantiles: NDArray[np.float64]
) -> NDArray[np.uint8]:
    voxels = len(offsets) - 1
    found = np.zeros((len(quantiles), voxels, 3), np.uint8)
    values = np.empty(MOST_OBSERVATIONS, np.uint8)
    for voxel in range(voxels):
        first, count = offsets[voxel], offsets[voxel + 1] - offsets[voxel]
        taken = min(count, MOST_OBSERVATIONS)
        if taken == 0:
            continue
        for channel in range(3):
            for k in range(taken):
                value = colours[first + k * count // taken, channel]
                place = k
                while place > 0 and values[place - 1] > value:
                    values[place] = values[place - 1]
                    place -= 1
                values[place] = value
            for q in range(len(quantiles)):
                found[q, voxel, channel] = values[int(quantiles[q] * (taken - 1))]
    return found
