# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The mesh of the shipped table against its true surface, and as a solid."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from reflest_core.export.scan_asset import AssetSettings, scan_asset
from reflest_core.export.scanned_mesh import mesh_of_voxels, scanned_mesh
from test.core.export.shipped_table import frames, scan, true_materials, true_surface

NEAR = 0.005


@pytest.fixture(scope="module")
def mesh():
    return scanned_mesh(scan(), 20_000)


@pytest.fixture(scope="module")
def solid():
    return scanned_mesh(scan(), 20_000, is_watertight=True)


def distances_to(mesh, places):
    """To points spread over the mesh, 2 mm apart."""
    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    points, _ = trimesh.sample.sample_surface(surface, 200_000, seed=1)
    return cKDTree(points).query(places)[0]


def test_the_true_surface_of_table_and_objects_is_there(mesh):
    places, materials = true_surface()
    is_there = distances_to(mesh, places) < NEAR
    assert is_there.mean() > 0.93
    assert is_there[materials > 0].mean() > 0.96


def test_objects_and_table_are_one_piece_without_tears(mesh):
    assert mesh.pieces().max() == 0
    edges = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, uses = np.unique(edges, axis=0, return_counts=True)
    # The table's rim alone is open, nothing around the objects.
    middles = mesh.vertices[edges[uses == 1]].mean(axis=1)
    centre = mesh.vertices.mean(axis=0)
    assert (np.abs(middles - centre)[:, :2].max(axis=1) > 0.2).all()
    assert (middles[:, 2] < 0.02).all()


def test_no_filling_lies_where_the_cameras_saw_through(mesh):
    points = trimesh.sample.sample_surface(
        trimesh.Trimesh(mesh.vertices, mesh.faces, process=False), 50_000, seed=1
    )[0]
    is_free = np.zeros(len(points), np.bool_)
    for frame in frames()[::3]:
        camera, to_camera = frame.intrinsics, np.linalg.inv(frame.T_world_camera)
        x, y, z = to_camera[:3, :3] @ points.T + to_camera[:3, 3:]
        u = np.rint(camera.fx * x / z + camera.cx).astype(int)
        v = np.rint(camera.fy * y / z + camera.cy).astype(int)
        is_seen = (z > 0) & (u >= 1) & (v >= 1) & (u < camera.width - 1) & (v < camera.height - 1)
        u, v = np.where(is_seen, u, 1), np.where(is_seen, v, 1)
        around = [frame.depth[v + dv, u + du] for dv in (-1, 0, 1) for du in (-1, 0, 1)]
        is_free |= is_seen & (np.min(around, axis=0) > z + 0.02)
    assert is_free.mean() < 0.005


def test_a_watertight_table_is_a_slab_with_a_flat_underside(solid):
    body = trimesh.Trimesh(solid.vertices, solid.faces, process=False)
    assert body.is_watertight
    assert body.is_winding_consistent
    assert body.body_count == 1
    observed = scan().store.rows.positions[: scan().store.count]
    assert (np.abs(body.bounds - [observed.min(axis=0), observed.max(axis=0)]) < 0.02).all()
    bottom = solid.vertices[:, 2].min()
    corners = solid.vertices[solid.faces]
    is_underside = (corners[..., 2] < bottom + 1e-5).all(axis=1)
    width, depth, _ = np.ptp(observed, axis=0)
    assert body.area_faces[is_underside].sum() > 0.9 * width * depth * 0.75
    places, materials = true_surface()
    assert (distances_to(solid, places)[materials > 0] < NEAR).mean() > 0.95


def test_the_base_follows_up(solid):
    rows, count = scan().store.rows, scan().store.count
    turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], np.float32)  # z becomes x
    turned = mesh_of_voxels(
        rows.positions[:count] @ turn.T,
        rows.normals[:count] @ turn.T,
        scan().fusion.voxel_size,
        20_000,
        is_watertight=True,
        up=(1.0, 0.0, 0.0),
    )
    assert turned.is_closed
    assert turned.vertices[:, 0].min() == pytest.approx(solid.vertices[:, 2].min(), abs=1e-4)


def test_a_watertight_export_has_every_object():
    towards = np.random.default_rng(0).normal(size=(6000, 3))
    normals = (towards / np.linalg.norm(towards, axis=1, keepdims=True)).astype(np.float32)
    smaller = normals * np.float32(0.04) + np.float32([0.3, 0.0, 0.0])
    positions = np.concatenate([normals * np.float32(0.05), smaller])
    mesh = mesh_of_voxels(positions, np.concatenate([normals, normals]), 0.005, 20_000, True)
    assert mesh.is_closed
    assert len(np.unique(mesh.pieces())) == 2
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), [0.39, 0.1, 0.1], atol=0.003)


def test_a_watertight_mesh_stays_closed_at_any_number_of_faces():
    for faces in (300, 2_000, 7_000):
        small = scanned_mesh(scan(), faces, is_watertight=True)
        assert len(small.faces) <= faces
        assert trimesh.Trimesh(small.vertices, small.faces, process=False).is_watertight


@pytest.mark.parametrize("is_watertight", [False, True])
def test_materials_follow_the_objects_edges(is_watertight):
    settings = AssetSettings(is_watertight=is_watertight)
    asset = scan_asset(scan(), true_materials(), "table", settings)
    surface = trimesh.Trimesh(asset.mesh.vertices, asset.mesh.faces, process=False)
    points, face = trimesh.sample.sample_surface(surface, 100_000, seed=1)
    labels = asset.mesh.face_materials[face]
    places, materials = true_surface()
    distances, near = cKDTree(places).query(points)
    is_right = labels == materials[near]
    is_true = distances < NEAR
    assert is_right[is_true].mean() > 0.995
    assert is_right[is_true & (materials[near] > 0)].mean() > 0.99
    # What was filled in between an object's lower edge and the table is the object's.
    is_steep = np.abs(surface.face_normals[face, 2]) < 0.75
    is_filled = ~is_true & is_steep & (points[:, 2] > 0.002)
    assert is_filled.sum() > 50
    assert (labels[is_filled] > 0).mean() > 0.97


def test_a_watertight_asset_is_closed_with_its_materials_and_seams():
    asset = scan_asset(scan(), true_materials(), "table", AssetSettings(is_watertight=True))
    body = trimesh.Trimesh(asset.mesh.vertices, asset.mesh.faces, process=False)
    body.merge_vertices(merge_norm=True, merge_tex=True)
    assert body.is_watertight
    assert len(asset.mesh.faces) <= 20_000
