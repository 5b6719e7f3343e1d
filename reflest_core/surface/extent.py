# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where a set of surface voxels lies and how large it is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

NEIGHBOURS = 6
"""A voxel's share of the surface comes from the distance to so many neighbours."""


@dataclass(frozen=True)
class Extent:
    """Position and size of V voxels.

    Attributes:
        centroid: (3,) mean position, world frame, metres.
        size: (3,) edges of the axis-aligned bounding box, metres.
        area: of the surface that the voxels lie on, square metres.
    """

    centroid: tuple[float, float, float]
    size: tuple[float, float, float]
    area: float


def voxel_extent(positions: NDArray[np.float32]) -> Extent:
    """Measure a set of voxels.

    Args:
        positions: (V, 3) float32, V >= 1, world frame, metres.
    """
    x, y, z = positions.mean(axis=0, dtype=np.float64).tolist()
    width, depth, height = np.ptp(positions, axis=0).astype(np.float64).tolist()
    area = float(surfel_areas(positions).sum(dtype=np.float64))
    return Extent((x, y, z), (width, depth, height), area)


def surfel_areas(positions: NDArray[np.float32]) -> NDArray[np.float32]:
    """Share a surface among its voxels.

    Args:
        positions: (V, 3) float32, metres.

    Returns:
        (V,) float32 square metres: the disc that reaches the sixth neighbour holds six voxels.
        Zeros where there are too few voxels.
    """
    if len(positions) <= NEIGHBOURS:
        return np.zeros(len(positions), np.float32)
    tree = cKDTree(positions, compact_nodes=False, balanced_tree=False)  # built in a third
    distances, _ = tree.query(positions, k=[NEIGHBOURS + 1])
    return np.asarray(math.pi * distances[:, -1] ** 2 / NEIGHBOURS, np.float32)
