# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which voxels stand for a large surface, at a cost that does not grow with it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled

LOOKED_AT = 16
"""Voxels that are compared at most to choose one."""


@compiled
def thinned(counts: NDArray[np.integer], most: int) -> NDArray[np.int64]:
    """At most ``most`` indices of voxels with observations, rising, spread evenly over ``counts``.

    ``counts``: (V,) observations of each voxel. All observed voxels where V does not pass ``most``;
    else the most often observed of the first :data:`LOOKED_AT` of each of ``most`` equal stretches.
    """
    stretches = min(most, len(counts))
    indices = np.empty(stretches, np.int64)
    found = 0
    for n in range(stretches):
        first = n * len(counts) // stretches
        last = min((n + 1) * len(counts) // stretches, first + LOOKED_AT)
        best = first
        for index in range(first + 1, last):
            if counts[index] > counts[best]:
                best = index
        if counts[best] > 0:
            indices[found] = best
            found += 1
    return indices[:found]
