# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a voxel shows without its highlights: a low quantile of its colours over the views."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.jit import compiled
from reflest_core.surface.observed_surface import ObservedSurface

QUANTILE = 0.15
"""Low, as a highlight only ever adds; not the least, which noise and occluders lower."""
MOST_COLOURS = 64
"""Observations of one voxel at most, taken evenly over the order in which they were made."""


def diffuse_colours(
    surface: ObservedSurface, voxels: NDArray[np.int64], quantile: float = QUANTILE
) -> NDArray[np.float32]:
    """Return a low quantile of each voxel's colours, in which highlights have little part.

    Args:
        surface: What was observed.
        voxels: (N,) indices of voxels.
        quantile: Of each channel, in [0, 1].

    Returns:
        (N, 3) linear colours; 1 in a channel means clipped.
    """
    eight_bit = _quantiles(surface.colours, surface.offsets, voxels, quantile)
    return np.asarray(srgb.LINEAR[eight_bit])


@compiled
def _quantiles(
    colours: NDArray[np.uint8],
    offsets: NDArray[np.int64],
    voxels: NDArray[np.int64],
    quantile: float,
) -> NDArray[np.uint8]:
    found = np.zeros((len(voxels), 3), np.uint8)
    kept = np.empty(MOST_COLOURS, np.uint8)
    for i in range(len(voxels)):
        first, last = offsets[voxels[i]], offsets[voxels[i] + 1]
        taken = min(last - first, MOST_COLOURS)
        for channel in range(3):
            for k in range(taken):
                kept[k] = colours[first + k * (last - first) // taken, channel]
            # The rank is low: sorting stops there.
            for place in range(int(quantile * max(taken - 1, 0)) + 1 if taken else 0):
                least = place
                for k in range(place + 1, taken):
                    if kept[k] < kept[least]:
                        least = k
                found[i, channel] = kept[least]
                kept[least] = kept[place]
    return found
