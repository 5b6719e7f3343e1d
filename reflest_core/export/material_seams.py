# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Triangles cut where the material changes, so that seams do not follow the triangulation."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from reflest_core.export.triangle_mesh import TriangleMesh

LabelAt = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.int32]]
"""(P,) labels at (P, 3) points of a surface with (P, 3) normals."""
BISECTIONS = 5
"""Halvings that find the place on an edge where the label changes."""
LEAST_PART = 0.1
"""No cut is nearer to an edge's end than this share of its length: slivers shade badly."""


def cut_at_seams(mesh: TriangleMesh, label_at: LabelAt) -> tuple[TriangleMesh, NDArray[np.int32]]:
    """Cut each triangle whose corners have different labels.

    An edge is cut once for both of its faces, so that a closed mesh stays closed.

    Args:
        mesh: The mesh.
        label_at: The label of a point of its surface.

    Returns:
        The cut mesh, and the (F,) label of each of its faces.
    """
    vertices, normals = mesh.vertices.astype(np.float64), mesh.vertex_normals.astype(np.float64)
    labels = label_at(vertices, normals)
    faces = mesh.faces.astype(np.int64)
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges = np.unique(edges[labels[edges[:, 0]] != labels[edges[:, 1]]], axis=0)
    if not len(edges):
        return mesh, labels[mesh.faces[:, 0]]
    keys = edges[:, 0] * len(vertices) + edges[:, 1]
    cuts = _cuts(vertices, normals, labels, edges, label_at)

    def cut_of(one: NDArray[np.int64], other: NDArray[np.int64]) -> NDArray[np.int64]:
        wanted = np.minimum(one, other) * len(vertices) + np.maximum(one, other)
        return np.asarray(len(vertices) + np.searchsorted(keys, wanted), np.int64)

    of_corners = labels[faces]
    is_same = of_corners == np.roll(of_corners, -1, axis=1)
    sames = is_same.sum(axis=1)
    whole, of_two, of_three = (faces[sames == n] for n in (3, 1, 0))
    # The corner that differs comes first: it lies opposite the edge of equal ends.
    first = (np.argmax(is_same[sames == 1], axis=1)[:, None] + 2 + np.arange(3)) % 3
    a, b, c = np.take_along_axis(of_two, first, axis=1).T
    ab, ac = cut_of(a, b), cut_of(a, c)
    parts = [(whole, whole[:, 0])]
    parts += [
        (np.stack(corners, axis=1), owner)
        for corners, owner in (((a, ab, ac), a), ((ab, b, c), b), ((ab, c, ac), c))
    ]
    middle = len(vertices) + len(cuts) + np.arange(len(of_three))
    for n in range(3):
        corner, after, before = (of_three[:, (n + k) % 3] for k in range(3))
        forward, backward = cut_of(corner, after), cut_of(corner, before)
        parts.append((np.stack([corner, forward, middle], axis=1), corner))
        parts.append((np.stack([corner, middle, backward], axis=1), corner))
    centres = vertices[of_three].mean(axis=1)
    return (
        TriangleMesh(
            np.concatenate([vertices, cuts, centres]).astype(np.float32),
            np.concatenate([corners for corners, _ in parts]).astype(np.int32),
        ),
        labels[np.concatenate([owner for _, owner in parts])],
    )


def _cuts(
    vertices: NDArray[np.float64],
    normals: NDArray[np.float64],
    labels: NDArray[np.int32],
    edges: NDArray[np.int64],
    label_at: LabelAt,
) -> NDArray[np.float64]:
    """(E, 3) points where the label of the edges' first ends gives way."""
    low, high = np.zeros((len(edges), 1)), np.ones((len(edges), 1))
    start, end = edges.T
    for _ in range(BISECTIONS):
        half = 0.5 * (low + high)
        found = label_at(
            (1 - half) * vertices[start] + half * vertices[end],
            (1 - half) * normals[start] + half * normals[end],
        )
        is_first = (found == labels[start])[:, None]
        low, high = np.where(is_first, half, low), np.where(is_first, high, half)
    share = np.clip(0.5 * (low + high), LEAST_PART, 1 - LEAST_PART)
    return np.asarray((1 - share) * vertices[start] + share * vertices[end])
