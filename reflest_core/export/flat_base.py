# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A flat base below a surface that was scanned from above, so that it can be closed.

Points of the base and of its side walls join the voxels before the reconstruction. The base lies
below the lowest voxels and is as large as what reaches down there: a table gets a slab, a vase the
foot it stands on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, binary_erosion, binary_fill_holes, gaussian_filter

from reflest_core.export.triangle_mesh import TriangleMesh
from reflest_core.surface.upright import rotation_to_z

THICKNESS = 3.0
"""Voxels between the base and the lowest of the surface."""
LOWEST = 1.0
"""Percentile of the voxels' heights that is the surface's lowest height."""
REACH = 10.0
"""Voxels above the lowest height within which a column of the surface stands on the base."""
CLOSED_CELLS = 3
"""Gaps of up to twice so many cells at the base's rim are closed."""
FACING_DOWN = -0.2
"""Cosine to up below which a voxel's normal faces down."""
CLOSED_BELOW = 0.5
"""A surface is closed below if the lowest voxel of this share of its columns faces down."""
MOST_CELLS = 2048
"""Of the grid of columns along each axis: things far apart get a coarser one."""
LEVELLED_WITHIN = 1.0
"""Vertices of the reconstruction within so many voxels of the base are put on it."""


@dataclass(frozen=True)
class FlatBase:
    """The points of a base, none where the surface is closed below.

    Attributes:
        positions: (B, 3) float32, metres.
        normals: (B, 3) float32, unit, outward.
        up: (3,) unit.
        height: Of the underside along ``up``, metres.
        reach: Vertices so near to the underside belong to it, metres.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    up: NDArray[np.float64]
    height: float
    reach: float

    def levelled(self, mesh: TriangleMesh) -> TriangleMesh:
        """Put the underside of a reconstruction exactly on the base.

        Args:
            mesh: Reconstructed from the voxels and these points.
        """
        if not len(self.positions):
            return mesh
        heights = mesh.vertices @ self.up
        shift = np.where(heights < self.height + self.reach, self.height - heights, 0.0)
        vertices = mesh.vertices + shift[:, None] * self.up
        return TriangleMesh(vertices.astype(np.float32), mesh.faces)


def base_below(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    voxel_size: float,
    up: tuple[float, float, float],
) -> FlatBase:
    """The base of voxels, if their surface is open below.

    Args:
        positions: (V, 3) metres.
        normals: (V, 3) unit, outward.
        voxel_size: Edge of a voxel, metres.
        up: Up in the voxels' frame.
    """
    rotation = rotation_to_z(up)
    upright = positions.astype(np.float64) @ rotation.T
    low = float(np.percentile(upright[:, 2], LOWEST))
    height = low - THICKNESS * voxel_size
    cell = max(voxel_size, float(np.ptp(upright[:, :2], axis=0).max()) / MOST_CELLS)
    corner = upright[:, :2].min(axis=0) - (CLOSED_CELLS + 2) * cell
    cells = np.floor((upright[:, :2] - corner) / cell).astype(np.int64)
    shape = tuple(cells.max(axis=0) + CLOSED_CELLS + 3)
    columns = tuple(cells.T)
    lowest = np.full(shape, np.inf)
    np.minimum.at(lowest, columns, upright[:, 2])
    is_lowest = upright[:, 2] == lowest[columns]
    is_down = (normals @ rotation[2] < FACING_DOWN)[is_lowest]
    points, of_points = np.zeros((0, 3)), np.zeros((0, 3))
    if is_down.mean() < CLOSED_BELOW:
        is_base = lowest < low + REACH * voxel_size
        is_base = binary_fill_holes(binary_closing(is_base, iterations=CLOSED_CELLS))
        below = np.argwhere(is_base)
        underside = np.column_stack([corner + (below + 0.5) * cell, np.full(len(below), height)])
        wall, of_wall = _walls(is_base, lowest, low, height, corner, cell)
        points = np.concatenate([underside, wall])
        of_points = np.concatenate([np.tile([0.0, 0.0, -1.0], (len(below), 1)), of_wall])
    return FlatBase(
        (points @ rotation).astype(np.float32),
        (of_points @ rotation).astype(np.float32),
        rotation[2],
        height,
        LEVELLED_WITHIN * voxel_size,
    )


def _walls(
    is_base: NDArray[np.bool_],
    lowest: NDArray[np.float64],
    low: float,
    height: float,
    corner: NDArray[np.float64],
    cell: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and outward normals of the walls from the base up to the surface at its rim."""
    rim = np.argwhere(is_base & ~binary_erosion(is_base))
    # The outline, blurred, falls outwards.
    slope = np.stack(np.gradient(-gaussian_filter(is_base.astype(np.float64), 2.0)), axis=-1)
    outward = slope[rim[:, 0], rim[:, 1]]
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-9)
    tops = lowest[rim[:, 0], rim[:, 1]]
    tops = np.where(np.isfinite(tops), tops, low)
    counts = np.maximum(np.floor((tops - height) / cell).astype(np.int64), 1)
    of_rim = np.repeat(np.arange(len(rim)), counts)
    step = np.arange(len(of_rim)) - np.repeat(np.cumsum(counts) - counts, counts)
    places = corner + (rim[of_rim] + 0.5 + 0.5 * outward[of_rim]) * cell
    points = np.column_stack([places, height + (step + 0.5) * cell])
    return points, np.column_stack([outward[of_rim], np.zeros(len(of_rim))])
