# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A triangle mesh with shading normals, as the renderer takes it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class TriangleMesh:
    """A mesh with shading normals; faces run anticlockwise seen from outside.

    Attributes:
        vertices: (V, 3) float64, metres.
        normals: (V, 3) float64, unit.
        faces: (F, 3) int64, vertex indices.
    """

    vertices: FloatArray
    normals: FloatArray
    faces: IntArray

    @property
    def face_areas(self) -> FloatArray:
        """(F,) square metres."""
        area: FloatArray = 0.5 * np.linalg.norm(_face_vectors(self.vertices, self.faces), axis=1)
        return area

    @property
    def diameter(self) -> float:
        """Twice the distance of the farthest vertex from the origin."""
        return 2.0 * float(np.linalg.norm(self.vertices, axis=1).max())

    def moved(self, rotation: FloatArray, diameter: float) -> TriangleMesh:
        """Centre the bounding box at the origin, rotate and scale.

        Args:
            rotation: (3, 3).
            diameter: metres, afterwards.
        """
        vertices = (self.vertices - _box_centre(self.vertices)) @ rotation.T
        vertices = vertices - _box_centre(vertices)
        scale = diameter / (2.0 * np.linalg.norm(vertices, axis=1).max())
        return TriangleMesh(vertices * scale, self.normals @ rotation.T, self.faces)

    def shifted(self, offset: FloatArray) -> TriangleMesh:
        """Move the mesh.

        Args:
            offset: (3,) metres.
        """
        return TriangleMesh(self.vertices + offset, self.normals, self.faces)

    def subdivided(self, longest: float) -> TriangleMesh:
        """Split faces into four until no edge is too long.

        Args:
            longest: edge, metres.
        """
        vertices, normals, faces = self.vertices, self.normals, self.faces
        while True:
            corners = vertices[faces]
            edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
            is_long = edges > longest
            if not is_long.any():
                return TriangleMesh(vertices, normals, faces)
            a, b, c = faces[is_long].T
            first, count = len(vertices), int(is_long.sum())
            ab, bc, ca = (first + k * count + np.arange(count) for k in range(3))
            pairs = np.concatenate([[a, b], [b, c], [c, a]], axis=1)
            middles = normals[pairs[0]] + normals[pairs[1]]
            middles /= np.maximum(np.linalg.norm(middles, axis=1, keepdims=True), 1e-12)
            vertices = np.concatenate([vertices, vertices[pairs].mean(axis=0)])
            normals = np.concatenate([normals, middles])
            quarters = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
            split = [np.stack(quarter, axis=1) for quarter in quarters]
            faces = np.concatenate([faces[~is_long], *split])


def with_crease_normals(
    vertices: FloatArray, faces: IntArray, crease_angle: float = 40.0
) -> TriangleMesh:
    """Shade smoothly across flat edges and keep sharper ones.

    A corner's normal is the area-weighted mean of those faces at its vertex that lie within the
    crease angle of its own face; every corner becomes a vertex.

    Args:
        vertices: (N, 3) metres.
        faces: (F, 3) vertex indices.
        crease_angle: degrees between faces from which on an edge is sharp.
    """
    faces = faces[np.linalg.norm(_face_vectors(vertices, faces), axis=1) > 0.0]
    weighted = _face_vectors(vertices, faces)
    unit = weighted / np.linalg.norm(weighted, axis=1, keepdims=True)
    corner_vertex = faces.reshape(-1)
    corner_face = np.repeat(np.arange(len(faces)), 3)
    order = np.argsort(corner_vertex, kind="stable")
    valence = np.bincount(corner_vertex, minlength=len(vertices))
    first = np.concatenate([[0], np.cumsum(valence)[:-1]])
    normals = np.zeros((len(corner_vertex), 3))
    cosine = np.cos(np.deg2rad(crease_angle))
    # One pass per slot of the largest fan of faces about a vertex.
    for slot in range(int(valence.max())):
        corners = np.nonzero(valence[corner_vertex] > slot)[0]
        neighbour = corner_face[order[first[corner_vertex[corners]] + slot]]
        alike = np.einsum("ij,ij->i", unit[corner_face[corners]], unit[neighbour]) >= cosine
        normals[corners[alike]] += weighted[neighbour[alike]]
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(length > 0.0, normals / np.maximum(length, 1e-300), unit[corner_face])
    return TriangleMesh(vertices[corner_vertex], normals, np.arange(3 * len(faces)).reshape(-1, 3))


def facing_outwards(vertices: FloatArray, faces: IntArray) -> IntArray:
    """Flip all faces if the signed volume that they enclose is negative.

    Args:
        vertices: (N, 3) metres.
        faces: (F, 3) vertex indices.
    """
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum()
    return faces if volume >= 0.0 else faces[:, ::-1]


def grid_faces(rows: int, columns: int, wrap_rows: bool, wrap_columns: bool) -> IntArray:
    """Triangles (F, 3) of a (rows, columns) grid of vertices, closed round where it wraps.

    Args:
        rows: of the picture or grid.
        columns: of the picture or grid.
        wrap_rows: whether the last row meets the first.
        wrap_columns: whether the last column meets the first.
    """
    row = np.arange(rows if wrap_rows else rows - 1)[:, None]
    column = np.arange(columns if wrap_columns else columns - 1)[None, :]
    next_row, next_column = (row + 1) % rows, (column + 1) % columns
    corner = [
        np.broadcast_to(r * columns + c, (row.size, column.size)).reshape(-1)
        for r, c in ((row, column), (next_row, column), (next_row, next_column), (row, next_column))
    ]
    halves = ((0, 1, 2), (0, 2, 3))
    return np.concatenate([np.stack([corner[k] for k in half], axis=1) for half in halves])


def _face_vectors(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Face normals (F, 3) of twice the face's area in length."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def _box_centre(vertices: FloatArray) -> FloatArray:
    centre: FloatArray = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    return centre
