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
    groups = [np.arange(len(positions))]
    for _ in range(HALVINGS):
        groups = [half for group in groups for half in _halves(positions, group)]
    parts = np.zeros(len(positions), np.int64)
    for part, group in enumerate(groups):
        parts[group] = part
    return parts


def _halves(
    positions: NDArray[np.float32], group: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The two halves of voxels with rising indices."""
    inside = positions[group]
    if len(group) == 0:
        return group, group
    longest = (inside.max(axis=0) - inside.min(axis=0)).argmax()
    order = np.argsort(inside[:, longest], kind="stable")
    middle = len(group) // 2
    return group[np.sort(order[:middle])], group[np.sort(order[middle:])]
