# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Points spread over a mesh: the voxels of a sparse scene."""

from __future__ import annotations

import enum

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.shapes.mesh import TriangleMesh


class SurfaceKind(enum.Enum):
    """Where a scene's voxels come from."""

    EXACT = "exact"
    """Points drawn evenly on the true surface, with its normals."""
    FUSED = "fused"
    """Voxels of :class:`.Scan`, fused from depth images of all views with the sensor's noise."""


def draw_surface_points(
    mesh: TriangleMesh,
    count: int,
    rng: np.random.Generator,
    weights: NDArray[np.float64] | None = None,
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int64]]:
    """Draw points uniformly over the area, or over its product with weights.

    Args:
        mesh: Triangles, metres.
        count: Points.
        rng: Source of the draw.
        weights: (F,) relative density on each face; None for 1.

    Returns:
        Positions and shading normals (count, 3), and the index (count,) of each point's face.
    """
    share = np.cumsum(mesh.face_areas if weights is None else mesh.face_areas * weights)
    faces = np.searchsorted(share, rng.uniform(0, share[-1], count), side="right")
    faces = np.minimum(faces, len(mesh.faces) - 1)
    corners = mesh.faces[faces]
    first, second = rng.uniform(size=(2, count))
    folded = first + second > 1
    first, second = np.where(folded, 1 - first, first), np.where(folded, 1 - second, second)
    weights = np.stack([1 - first - second, first, second], axis=1)
    positions = np.einsum("pc,pck->pk", weights, mesh.vertices[corners])
    normals = np.einsum("pc,pck->pk", weights, mesh.normals[corners])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return positions.astype(np.float32), normals.astype(np.float32), faces
