# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How much of the directions from which voxels can be seen has been seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.tangent_frame import tangent_frame

RINGS = 4
SECTORS = 8


def hemisphere_coverage(surface: ObservedSurface, voxels: NDArray[np.int64]) -> float:
    """Measure how much of each voxel's hemisphere was looked at from.

    The hemisphere has 32 cells of equal area: 4 rings of equal height in ``omega_o . n`` by 8
    sectors of azimuth.

    Args:
        surface: What was observed.
        voxels: (N,) indices of voxels.

    Returns:
        Mean share in [0, 1] of the cells that hold a view; 0 for no voxels.
    """
    if len(voxels) == 0:
        return 0.0
    return float(seen_cells(surface, voxels).sum()) / (len(voxels) * RINGS * SECTORS)


def seen_cells(surface: ObservedSurface, voxels: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Find the cells of each voxel's hemisphere that hold a view.

    Args:
        surface: What was observed.
        voxels: (N,) indices of voxels.

    Returns:
        (N, RINGS, SECTORS): rings by rising ``omega_o . n``, sectors by rising azimuth from
        -180 degrees in the voxel's :func:`.tangent_frame`.
    """
    return _seen_cells(
        surface.positions,
        surface.normals,
        surface.offsets,
        surface.view_indices,
        surface.view_centres,
        voxels,
    )


@compiled
def _seen_cells(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    offsets: NDArray[np.int64],
    view_indices: NDArray[np.uint16],
    view_centres: NDArray[np.float32],
    voxels: NDArray[np.int64],
) -> NDArray[np.bool_]:
    cells = np.zeros((len(voxels), RINGS, SECTORS), np.bool_)
    for row in range(len(voxels)):
        voxel, seen = voxels[row], cells[row]
        normal = normals[voxel]
        tx, ty, tz, bx, by, bz = tangent_frame(normal)
        for index in range(offsets[voxel], offsets[voxel + 1]):
            centre = view_centres[view_indices[index]]
            dx = centre[0] - positions[voxel, 0]
            dy = centre[1] - positions[voxel, 1]
            dz = centre[2] - positions[voxel, 2]
            length = np.sqrt(dx * dx + dy * dy + dz * dz)
            if length == 0:
                continue
            cosine = (dx * normal[0] + dy * normal[1] + dz * normal[2]) / length
            if cosine <= 0:
                continue
            turn = np.arctan2(dx * bx + dy * by + dz * bz, dx * tx + dy * ty + dz * tz)
            ring = min(int(cosine * RINGS), RINGS - 1)
            sector = min(int((turn / (2 * np.pi) + 0.5) * SECTORS), SECTORS - 1)
            seen[ring, sector] = True
    return cells
