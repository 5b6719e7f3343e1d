# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Voxels in spatial parts of equal size, whose errors are nearly independent of each other's."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

HALVINGS = 3
PARTS = 2**HALVINGS


def spatial_parts(positions: NDArray[np.float32]) -> NDArray[np.int64]:
    """Divide voxels in space: each group is halved at the median along its longest extent.

    Args:
        positions: (V, 3), metres.

    Returns:
        (V,) the part of each voxel, 0 to :data:`PARTS` - 1.
    """
    parts = np.zeros(len(positions), np.int64)
    for _ in range(HALVINGS):
        halves = 2 * parts
        for part in np.unique(parts):
            inside = np.flatnonzero(parts == part)
            extents = np.ptp(positions[inside], axis=0)
            order = np.argsort(positions[inside, extents.argmax()], kind="stable")
            halves[inside[order[len(inside) // 2 :]]] += 1
        parts = halves
    return parts
