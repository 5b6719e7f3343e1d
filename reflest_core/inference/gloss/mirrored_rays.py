# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which mirrored rays leave the object, found by marching through its occupied cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled

MOST_CELLS = 96
"""Along the longest edge of the grid; a larger surface has larger cells."""
SPACINGS = 1.5
"""Cell size in units of the voxels' spacing, so that a surface has no gaps."""
OCCUPIED, OUTSIDE = 1, 2
START, STEP = 1.6, 0.6
"""In cells: how far above the surface a ray begins, and how far it goes at a time."""


@dataclass(frozen=True)
class OccupiedCells:
    """A surface as occupied cells of a regular grid.

    Attributes:
        cells: (X, Y, Z) uint8, :data:`OCCUPIED` where the surface passes, and around it all a layer
            of :data:`OUTSIDE`.
        origin: (3,) of the first cell's corner, metres.
        size: Of a cell, metres.
    """

    cells: NDArray[np.uint8]
    origin: NDArray[np.float64]
    size: float

    @staticmethod
    def of(positions: NDArray[np.float32]) -> OccupiedCells:
        """Return the cells of voxels at ``positions`` (V, 3), metres.

        Args:
            positions: (V, 3), metres.

        Returns:
            The grid; an empty surface occupies nothing.
        """
        if len(positions) == 0:
            return OccupiedCells(np.full((1, 1, 1), OUTSIDE, np.uint8), np.zeros(3), 1.0)
        by_axis = np.ascontiguousarray(positions.T)  # whose bounds NumPy finds ten times faster
        least, most = (bound(by_axis, axis=1).astype(np.float64) for bound in (np.min, np.max))
        extent = most - least
        # Voxels of a closed surface: area is about that of the box around it.
        area = 2.0 * (extent[0] * extent[1] + extent[1] * extent[2] + extent[2] * extent[0])
        spacing = np.sqrt(max(area, 1e-12) / len(positions))
        size = max(SPACINGS * spacing, float(extent.max()) / MOST_CELLS, 1e-6)
        origin = least - size
        cells = np.full(np.ceil(extent / size).astype(np.int64) + 3, OUTSIDE, np.uint8)
        cells[1:-1, 1:-1, 1:-1] = 0
        x, y, z = ((positions - origin) / size).astype(np.int64).T
        cells[x, y, z] = OCCUPIED
        return OccupiedCells(cells, origin, size)


@compiled
def leaves_object(
    cells: NDArray[np.uint8],
    x: float,
    y: float,
    z: float,
    step_x: float,
    step_y: float,
    step_z: float,
) -> bool:
    """Return whether a ray meets no occupied cell.

    Args:
        cells: See :class:`OccupiedCells`.
        x: Where the ray begins, in cells from the grid's origin, and so ``y`` and ``z``.
        y: See ``x``.
        z: See ``x``.
        step_x: One step of the ray, less than a cell, and so ``step_y`` and ``step_z``.
        step_y: See ``step_x``.
        step_z: See ``step_x``.

    Returns:
        True if the ray leaves the grid.
    """
    columns, rows, layers = cells.shape
    if not (abs(step_x) < 1.0 and abs(step_y) < 1.0 and abs(step_z) < 1.0):
        return False  # would jump over the outermost layer
    if not (1.0 <= x < columns - 1 and 1.0 <= y < rows - 1 and 1.0 <= z < layers - 1):
        return True
    for _ in range(4 * (columns + rows + layers)):
        x, y, z = x + step_x, y + step_y, z + step_z
        found = cells[np.uint32(x), np.uint32(y), np.uint32(z)]
        if found != 0:
            return bool(found == OUTSIDE)
    return True
