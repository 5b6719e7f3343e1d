# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Charts: cut where they must be, without overlap, and not too distorted."""

import numpy as np
import pytest
import trimesh

from reflest_core.export.atlas import unwrapped
from reflest_core.export.bake import covered_texels
from reflest_core.export.triangle_mesh import TriangleMesh


def mesh_of(shape):
    return TriangleMesh(shape.vertices.astype(np.float32), shape.faces.astype(np.int32))


SHAPES = {
    "ball": mesh_of(trimesh.creation.icosphere(4, 0.1)),
    "box": mesh_of(trimesh.creation.box((0.1, 0.2, 0.3)).subdivide().subdivide().subdivide()),
    "ring": mesh_of(trimesh.creation.torus(0.1, 0.03, 64, 32)),
}


@pytest.mark.parametrize("name", SHAPES)
def test_charts_lie_in_the_page_and_do_not_overlap(name):
    mesh = SHAPES[name]
    atlas = unwrapped(mesh, np.zeros(len(mesh.faces), np.int32), 256)
    assert atlas.uv.min() >= 0.0
    assert atlas.uv.max() <= 1.0
    texels, _, weights = covered_texels(atlas.uv, atlas.faces, 256)
    # A texel on the edge between two faces is in both.
    inner = texels[weights.min(axis=1) > 1e-6]
    assert len(np.unique(inner)) == len(inner)
    assert len(np.unique(texels)) > 0.35 * 256**2


@pytest.mark.parametrize("name", SHAPES)
def test_the_cut_mesh_is_the_mesh(name):
    mesh = SHAPES[name]
    atlas = unwrapped(mesh, np.zeros(len(mesh.faces), np.int32), 256)
    np.testing.assert_array_equal(
        mesh.vertices[atlas.source][atlas.faces], mesh.vertices[mesh.faces]
    )


@pytest.mark.parametrize("name", SHAPES)
def test_texels_cover_like_areas(name):
    mesh = SHAPES[name]
    atlas = unwrapped(mesh, np.zeros(len(mesh.faces), np.int32), 256)
    corners = atlas.uv[atlas.faces].astype(np.float64)
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    in_page = 0.5 * (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    on_surface = 0.5 * np.linalg.norm(mesh.face_normals, axis=1)
    ratios = np.abs(in_page) / on_surface
    assert np.percentile(ratios, 2) > 0.5 * ratios.max()


def test_no_chart_holds_two_labels():
    mesh = SHAPES["ball"]
    labels = (mesh.vertices[mesh.faces].mean(axis=1)[:, 2] > 0).astype(np.int32)
    atlas = unwrapped(mesh, labels, 256)
    assert not np.isin(atlas.faces[labels == 0], atlas.faces[labels == 1]).any()


def test_faces_too_small_for_a_chart_are_not_drawn_across_others():
    ball = SHAPES["ball"]
    # A needle on the ball whose projection has no area, between corners of faces of two charts.
    tip = ball.vertices[ball.faces[0, 0]]
    far = np.flatnonzero(ball.vertices @ tip < 0)[:1]
    needle = np.array([[ball.faces[0, 0], ball.faces[0, 0], far[0]]], np.int32)
    mesh = TriangleMesh(ball.vertices, np.concatenate([ball.faces, needle]))
    atlas = unwrapped(mesh, np.zeros(len(mesh.faces), np.int32), 256)
    corners = atlas.uv[atlas.faces]
    reach = np.linalg.norm(corners - corners[:, [1, 2, 0]], axis=2).max(axis=1)
    assert reach[:-1].max() < 0.1
    _, face, _ = covered_texels(atlas.uv, atlas.faces, 256)
    assert len(mesh.faces) - 1 not in face
