# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Seams between materials: where they lie, and that no cut opens the mesh."""

import numpy as np
import trimesh

from reflest_core.export.material_seams import cut_at_seams
from reflest_core.export.triangle_mesh import TriangleMesh


def ball(subdivisions=3):
    sphere = trimesh.creation.icosphere(subdivisions, radius=0.1)
    return TriangleMesh(sphere.vertices.astype(np.float32), sphere.faces.astype(np.int32))


def in_sectors(places, normals):
    """Three labels, which meet at the poles."""
    angle = np.arctan2(places[:, 1] - 0.003, places[:, 0] + 0.002)
    return np.floor((angle + np.pi) / (2 * np.pi) * 2.999).astype(np.int32)


def corners_of(mesh):
    return mesh.vertices[mesh.faces].astype(np.float64)


def test_a_seam_lies_where_the_label_changes_and_not_at_the_next_edge():
    mesh = ball()
    cut, labels = cut_at_seams(mesh, lambda p, n: (p[:, 2] > 0.013).astype(np.int32))
    heights = corners_of(cut)[..., 2]
    # Faces are 15 mm wide; a curved border between two cuts deviates a little.
    assert heights[labels == 1].min() > 0.013 - 0.002
    assert heights[labels == 0].max() < 0.013 + 0.002
    before = corners_of(mesh)[..., 2]
    assert (before.max(axis=1) - 0.013 > 0.005).sum() > 0
    assert len(cut.faces) < len(mesh.faces) + 200


def test_the_surface_stays_closed_and_as_it_was():
    mesh = ball()
    cut, labels = cut_at_seams(mesh, in_sectors)
    assert set(labels) == {0, 1, 2}
    assert cut.is_closed
    body = trimesh.Trimesh(cut.vertices, cut.faces, process=False)
    whole = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert body.is_watertight
    np.testing.assert_allclose(body.volume, whole.volume, rtol=1e-5)
    np.testing.assert_allclose(body.area, whole.area, rtol=1e-5)
    middles = corners_of(cut).mean(axis=1)
    is_right = in_sectors(middles, middles) == labels
    assert cut.face_areas[is_right].sum() > 0.99 * body.area


def test_a_mesh_of_one_label_is_left_as_it_is():
    mesh = ball()
    cut, labels = cut_at_seams(mesh, lambda p, n: np.full(len(p), 4, np.int32))
    np.testing.assert_array_equal(cut.faces, mesh.faces)
    assert (labels == 4).all()
