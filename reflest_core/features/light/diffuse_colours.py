# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a voxel shows without its highlights: a low quantile of its colours over the views."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.fusion.observed_surface import ObservedSurface
from reflest_core.jit import compiled

QUANTILE = 0.15
"""Low, as a highlight only ever adds; not the least, which noise and occluders lower."""
LOOKED_AT = 64
"""Observations of one voxel at most, taken evenly over the order in which they were made."""


def diffuse_colours(
    surface: ObservedSurface, voxels: NDArray[np.int64], quantile: float = QUANTILE
) -> NDArray[np.float32]:
    """(V, 3) linear colour of each of ``voxels``; 1 in a channel says that it is clipped."""
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
    for i in range(len(voxels)):
        first, last = offsets[voxels[i]], offsets[voxels[i] + 1]
        taken = min(last - first, LOOKED_AT)
        rows = first + np.arange(taken) * (last - first) // max(taken, 1)
        rank = int(quantile * max(taken - 1, 0))
        for channel in range(3):
            found[i, channel] = np.sort(colours[rows, channel])[rank]
    return found
