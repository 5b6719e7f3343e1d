# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A triangle mesh, its loose pieces, and its decimation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from reflest_core.export.libraries import library

CLOSED_TARGETS = (1.0, 0.97, 0.94, 0.91, 0.88, 0.8, 0.7)
"""Shares of the faces asked for, which are tried until a closed mesh is still closed."""


@dataclass(frozen=True)
class TriangleMesh:
    """Vertices and triangles in the world frame.

    Attributes:
        vertices: (N, 3) float32, metres.
        faces: (F, 3) int32, counter-clockwise from outside.
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.int32]

    @property
    def face_normals(self) -> NDArray[np.float64]:
        """(F, 3) outward normals whose length is twice the face's area."""
        corners = self.vertices[self.faces].astype(np.float64)
        return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])

    @property
    def vertex_normals(self) -> NDArray[np.float32]:
        """(N, 3) unit mean of the faces' normals, weighted by area."""
        normals = np.zeros((len(self.vertices), 3))
        of_faces = self.face_normals
        for corner in range(3):
            for axis in range(3):
                normals[:, axis] += np.bincount(
                    self.faces[:, corner], of_faces[:, axis], len(self.vertices)
                )
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        return np.where(lengths > 1e-12, normals / np.maximum(lengths, 1e-12), [0, 0, 1]).astype(
            np.float32
        )

    def kept(self, is_kept: NDArray[np.bool_]) -> TriangleMesh:
        """The faces that are kept, and their vertices.

        Args:
            is_kept: (F,) bool.
        """
        used, flat = np.unique(self.faces[is_kept], return_inverse=True)
        return TriangleMesh(self.vertices[used], flat.reshape(-1, 3).astype(np.int32))

    @property
    def face_areas(self) -> NDArray[np.float64]:
        """(F,) area of each face, square metres."""
        return np.asarray(0.5 * np.linalg.norm(self.face_normals, axis=1))

    def pieces(self) -> NDArray[np.int64]:
        """(F,) index of the connected piece that each face belongs to."""
        faces = self.faces
        links = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
        size = (len(self.vertices),) * 2
        graph = coo_matrix((np.ones(len(links), np.int8), (links[:, 0], links[:, 1])), size)
        _, piece_of_vertex = connected_components(graph, directed=False)
        return np.asarray(piece_of_vertex[faces[:, 0]], np.int64)

    @property
    def is_closed(self) -> bool:
        """Whether each edge is shared by two faces, which run along it in opposite directions."""
        starts, ends = self.faces, np.roll(self.faces, -1, axis=1)
        forward = np.stack([starts, ends], axis=-1).reshape(-1, 2).astype(np.int64)
        size = max(len(self.vertices), 1)
        keys = np.sort(forward[:, 0] * size + forward[:, 1])
        turned = np.sort(forward[:, 1] * size + forward[:, 0])
        return bool((keys[1:] != keys[:-1]).all() and np.array_equal(keys, turned))


def decimated(mesh: TriangleMesh, faces: int) -> TriangleMesh:
    """Simplify a mesh by quadric error metrics (Garland and Heckbert 1997).

    Args:
        mesh: Any mesh; a closed one stays closed.
        faces: About so many are left.

    Raises:
        ExportError: A package of the extra ``asset`` is missing.
    """
    if len(mesh.faces) <= faces:
        return _without_flat_faces(mesh)
    if not mesh.is_closed:
        return _without_flat_faces(_simplified(mesh, faces))
    # Collapses may join two sheets at an edge: other targets take other turns.
    for share in CLOSED_TARGETS:
        found = _simplified(mesh, int(share * faces))
        if found.is_closed:
            return found
    return mesh


def _simplified(mesh: TriangleMesh, faces: int) -> TriangleMesh:
    simplify: Any = library("fast_simplification").simplify
    vertices, triangles = simplify(mesh.vertices, mesh.faces, target_count=faces)
    return TriangleMesh(vertices.astype(np.float32), triangles.astype(np.int32))


def _without_flat_faces(mesh: TriangleMesh) -> TriangleMesh:
    """An open mesh without faces that have no area; a closed one as it is."""
    is_flat = ~(mesh.face_areas > 0.0)
    return mesh if mesh.is_closed or not is_flat.any() else mesh.kept(~is_flat)
