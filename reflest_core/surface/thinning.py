# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which voxels stand for a large surface, at a cost that does not grow with it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled

COMPARED = 16
"""Voxels that are compared at most to choose one."""


@compiled
def thinned(counts: NDArray[np.integer], most: int) -> NDArray[np.int64]:
    """Choose voxels that are spread evenly over a surface; a kernel.

    All observed voxels where V does not pass ``most``; else the most often observed of the first
    :data:`COMPARED` of each of ``most`` equal stretches.

    Args:
        counts: (V,) observations of each voxel.
        most: Most voxels.

    Returns:
        Indices of at most ``most`` voxels with observations, rising.
    """
    stretches = min(most, len(counts))
    indices = np.empty(stretches, np.int64)
    found = 0
    for n in range(stretches):
        first = n * len(counts) // stretches
        last = min((n + 1) * len(counts) // stretches, first + COMPARED)
        best = first
        for index in range(first + 1, last):
            if counts[index] > counts[best]:
                best = index
        if counts[best] > 0:
            indices[found] = best
            found += 1
    return indices[:found]
