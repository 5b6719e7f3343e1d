# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""OBJ and PLY read back as the asset that they were written from."""

import numpy as np
import plyfile
import pytest
import trimesh

from reflest_core.export.exporter import export_asset, export_estimate
from reflest_core.export.microfacet_material import MicrofacetMaterial
from reflest_core.export.scan_asset import AssetSettings, scan_asset
from test.core.export.estimates import GLOSSY_RED
from test.core.export.scanned_ball import RED_ID, STRIPED_ID, scanned_ball


@pytest.fixture(scope="module")
def ball():
    return scan_asset(*scanned_ball(), "ball", AssetSettings(faces=1000))


def test_an_obj_has_a_group_and_a_material_for_each_part(ball, tmp_path):
    path = tmp_path / "ball.obj"
    export_asset(ball, path)
    assert {one.name for one in tmp_path.iterdir()} == {
        "ball.obj",
        "ball.mtl",
        "ball_base_colour.png",
    }
    scene = trimesh.load_scene(path, split_object=True, group_material=True)
    assert len(scene.geometry) == 2
    total = sum(len(part.faces) for part in scene.geometry.values())
    assert total == len(ball.mesh.faces)
    by_height = sorted(scene.geometry.values(), key=lambda part: -part.vertices[:, 2].mean())
    assert by_height[0].vertices[:, 2].mean() > 0.03
    materials = (tmp_path / "ball.mtl").read_text().split("newmtl ")[1:]
    assert [one.split()[0] for one in materials] == ["ball_material_7", "ball_material_3"]
    for text, material in zip(materials, ball.materials, strict=True):
        microfacet = MicrofacetMaterial.from_ward(material.ward)
        assert f"Pr {microfacet.roughness:.6f}" in text
        assert "map_Kd ball_base_colour.png" in text


def test_an_obj_keeps_each_corners_texture_coordinates(ball, tmp_path):
    export_asset(ball, tmp_path / "ball.obj")
    lines = (tmp_path / "ball.obj").read_text().splitlines()
    vertices = np.array([line.split()[1:] for line in lines if line.startswith("v ")], float)
    uv = np.array([line.split()[1:] for line in lines if line.startswith("vt ")], float)
    corners = np.array(
        [[c.split("/") for c in line.split()[1:]] for line in lines if line.startswith("f ")], int
    )
    order = np.argsort(ball.mesh.face_materials, kind="stable")
    np.testing.assert_allclose(
        vertices[corners[..., 0] - 1], ball.mesh.vertices[ball.mesh.faces[order]], atol=1e-6
    )
    np.testing.assert_allclose(
        uv[corners[..., 1] - 1], ball.mesh.uv[ball.mesh.faces[order]], atol=1e-6
    )


def test_a_ply_has_colours_and_values_at_its_vertices(ball, tmp_path):
    path = tmp_path / "ball.ply"
    export_asset(ball, path)
    read = plyfile.PlyData.read(path)
    vertex = read["vertex"]
    places = np.stack([vertex[axis] for axis in "xyz"], axis=1)
    np.testing.assert_allclose(places, ball.mesh.vertices, atol=1e-6)
    assert len(read["face"]) == len(ball.mesh.faces)
    assert set(np.unique(vertex["material_id"])) == {RED_ID, STRIPED_ID}
    of_red = vertex["material_id"] == RED_ID
    assert np.unique(vertex["rho_s"][of_red]).tolist() == [np.float32(0.2)]
    assert np.unique(vertex["alpha"][~of_red]).tolist() == [np.float32(0.2)]
    np.testing.assert_allclose(vertex["rho_d_g_stddev"], 0.05)
    assert np.unique(vertex["rho_s_stddev"][~of_red]).tolist() == [-1.0]
    assert vertex["red"][of_red].min() > vertex["blue"][of_red].max()


@pytest.mark.parametrize("name", ["obj", "ply"])
def test_a_sphere_is_of_one_colour(name, tmp_path):
    path = tmp_path / f"material.{name}"
    export_estimate(GLOSSY_RED, name, path)
    mesh = trimesh.load_mesh(path, process=False)
    assert np.abs(mesh.bounds).max() == pytest.approx(0.05, abs=1e-5)
