# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Surfaces as the zero set of a field, made into triangles by marching cubes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.ndimage import map_coordinates
from skimage.measure import label, marching_cubes

from reflest_core.synbrdf.shapes.mesh import FloatArray, TriangleMesh, facing_outwards

Field = Callable[[FloatArray], FloatArray]
"""Takes points (..., 3) and returns values (...), negative inside."""

RESOLUTION = 56
EXTENT = 1.6
"""The field is sampled in the cube [-EXTENT, EXTENT]^3; a shape lies well inside."""


class EmptyShape(ValueError):
    """The field has no surface inside the cube."""


def mesh_of(field: Field, resolution: int = RESOLUTION) -> TriangleMesh:
    """Return the outer surface of the largest connected solid, normals from the gradient.

    Args:
        field: signed distance, negative inside.
        resolution: cells along an edge.
    """
    axis = np.linspace(-EXTENT, EXTENT, resolution)
    spacing = float(axis[1] - axis[0])
    values = field(np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1))
    values = _largest_solid(values)
    vertices, faces, _, _ = marching_cubes(values, 0.0)
    gradient = np.stack(
        [
            map_coordinates(component, vertices.T, order=1)
            for component in np.gradient(values, spacing)
        ],
        axis=1,
    )
    length = np.linalg.norm(gradient, axis=1, keepdims=True)
    points = vertices.astype(np.float64) * spacing - EXTENT
    outwards = facing_outwards(points, faces.astype(np.int64))
    return TriangleMesh(points, gradient / np.maximum(length, 1e-12), outwards)


def _largest_solid(values: FloatArray) -> FloatArray:
    """Drop what is not connected to the largest solid, and fill the hollows inside it."""
    values = values.copy()
    # A rim of outside closes any surface that would leave the cube.
    for axis in range(3):
        rim = np.moveaxis(values, axis, 0)
        rim[[0, -1]] = np.maximum(rim[[0, -1]], 1e-3)
    solids = label(values < 0.0, connectivity=1)
    sizes = np.bincount(solids.reshape(-1))
    if len(sizes) < 2:
        raise EmptyShape("the field is positive everywhere")
    sizes[0] = 0
    kept = solids == sizes.argmax()
    outside = label(~kept, connectivity=1)
    hollow = ~kept & (outside != outside[0, 0, 0])
    values = np.where((values < 0.0) & ~kept, 1e-3, values)
    return np.where(hollow, -1e-3, values)
