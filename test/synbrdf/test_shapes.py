# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
from collections import Counter

import numpy as np
import pytest

from reflest_core.synbrdf.scenes.surface_points import draw_surface_points
from reflest_core.synbrdf.shapes.mesh_file import MeshUnreadable, find_meshes, load_mesh
from reflest_core.synbrdf.shapes.procedural import KINDS, draw_procedural, draw_rotation
from test.synbrdf.spheres import icosphere, write_obj

SEEDS = range(3)


def welded_faces(mesh):
    """Faces over vertices merged by position, without those that collapse."""
    scale = np.ptp(mesh.vertices, axis=0).max()
    _, index = np.unique((mesh.vertices / scale).round(7), axis=0, return_inverse=True)
    faces = index.reshape(-1)[mesh.faces]
    a, b, c = faces.T
    return faces[(a != b) & (b != c) & (a != c)]


def signed_volume(mesh):
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", SEEDS)
def test_every_kind_is_closed_outward_and_smoothly_shaded(kind, seed):
    mesh, name = draw_procedural(np.random.default_rng(seed), kind)
    assert name == kind
    assert np.isfinite(mesh.vertices).all()
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-6)
    faces = welded_faces(mesh)
    edges = Counter((int(face[k]), int(face[(k + 1) % 3])) for face in faces for k in range(3))
    unmatched = sum(edges[b, a] != count for (a, b), count in edges.items())
    assert unmatched <= 0.01 * len(edges)
    assert signed_volume(mesh) > 0
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    face_normals = np.cross(b - a, c - a)
    area = np.linalg.norm(face_normals, axis=1)
    shading = mesh.normals[mesh.faces].mean(axis=1)
    agreeing = np.einsum("ij,ij->i", face_normals, shading) > 0
    assert area[agreeing].sum() > 0.99 * area.sum()


@pytest.mark.parametrize("kind", KINDS)
def test_seeds_give_distinct_shapes_and_the_same_seed_the_same(kind):
    meshes = [draw_procedural(np.random.default_rng(seed), kind)[0] for seed in (*SEEDS, 0)]
    assert len({mesh.vertices.tobytes() for mesh in meshes}) == len(SEEDS)
    np.testing.assert_array_equal(meshes[0].vertices, meshes[-1].vertices)


def test_any_kind_is_drawn():
    rng = np.random.default_rng(2)
    assert {draw_procedural(rng)[1] for _ in range(25)} == set(KINDS)


def test_moved_centres_and_scales():
    rotation = draw_rotation(np.random.default_rng(0), upright=False)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    mesh = icosphere(2, 3.0, centre=(5.0, 1.0, 0.0)).moved(rotation, 0.4)
    assert mesh.diameter == pytest.approx(0.4)
    np.testing.assert_allclose(mesh.vertices.min(0) + mesh.vertices.max(0), 0, atol=1e-9)
    upright = draw_rotation(np.random.default_rng(0), upright=True)
    np.testing.assert_allclose(upright[2], [0, 0, 1], atol=1e-12)


def test_surface_points_lie_on_the_surface_evenly():
    mesh = icosphere(4)
    positions, normals, faces = draw_surface_points(mesh, 20_000, np.random.default_rng(1))
    corners = mesh.vertices[mesh.faces[faces]]
    assert np.linalg.norm(positions - corners.mean(axis=1), axis=1).max() < np.ptp(corners, 1).max()
    np.testing.assert_allclose(np.linalg.norm(positions, axis=1), 1.0, atol=2e-3)
    np.testing.assert_allclose(normals, positions, atol=2e-3)
    # Archimedes: on a sphere every coordinate is uniform in [-1, 1].
    counts, _ = np.histogram(positions[:, 2], bins=8, range=(-1, 1))
    np.testing.assert_allclose(counts, 2500, rtol=0.08)


def test_mesh_files_of_each_kind_hold_the_same_mesh(tmp_path):
    sphere = icosphere(2)
    write_obj(tmp_path / "a.obj", sphere)
    stored = np.rint((sphere.vertices + 1) * 32767.5).astype(np.uint16)
    np.savez(tmp_path / "b.npz", **{"ball/v": stored, "ball/f": sphere.faces.astype(np.uint16)})
    sources = find_meshes(tmp_path)
    assert [source.name for source in sources] == ["a", "ball"]
    for mesh in map(load_mesh, sources):
        assert signed_volume(mesh) == pytest.approx(signed_volume(sphere), rel=1e-3)
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-6)


def test_unusable_meshes_are_refused_by_name(tmp_path):
    with pytest.raises(MeshUnreadable, match="holds no mesh"):
        find_meshes(tmp_path)
    (tmp_path / "odd.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    with pytest.raises(MeshUnreadable, match=r"odd.*does not exist"):
        load_mesh(find_meshes(tmp_path)[0])
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    for content in (
        f"{corners}f 1 2 99999999999999999999\n",
        f"{corners}f -9 -2 -1\n",
        f"{corners}f 1\nf\n",
        "v 1e308 0 0\nv -1e308 0 0\nv 0 1e308 0\nf 1 2 3\n",
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
        "f a b c\n",
    ):
        (tmp_path / "odd.obj").write_text(content)
        with pytest.raises(MeshUnreadable, match="odd"):
            load_mesh(find_meshes(tmp_path)[0])
    (tmp_path / "odd.obj").write_text("v 0 0 zero\n")
    with pytest.raises(MeshUnreadable, match="odd"):
        load_mesh(find_meshes(tmp_path)[0])
    (tmp_path / "odd.npz").write_bytes(b"nonsense")
    with pytest.raises(MeshUnreadable, match=r"odd\.npz"):
        find_meshes(tmp_path)


def test_subdividing_keeps_the_surface_and_shortens_every_edge():
    coarse = icosphere(1)
    fine = coarse.subdivided(0.1)
    edges = np.linalg.norm(np.diff(fine.vertices[fine.faces], axis=1, append=0), axis=2)[:, :2]
    assert edges.max() <= 0.1
    assert fine.face_areas.sum() == pytest.approx(coarse.face_areas.sum())
    np.testing.assert_allclose(np.linalg.norm(fine.normals, axis=1), 1.0)
    assert len(coarse.subdivided(10.0).faces) == len(coarse.faces)
