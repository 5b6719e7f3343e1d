# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Trimesh and Khronos' validator read what was written; values mean what the specification says."""

import json
import subprocess

import numpy as np
import pytest
import trimesh

from reflest_core.export.exporter import export_asset, export_estimate
from reflest_core.export.scan_asset import AssetSettings, scan_asset
from test.core.export.estimates import GLOSSY_RED
from test.core.export.scanned_ball import RADIUS, VOXEL, scanned_ball
from test.web.browser import WEB, needs_node


@pytest.fixture(scope="module")
def ball():
    return scan_asset(*scanned_ball(), "ball", AssetSettings(faces=3000))


@pytest.mark.parametrize("name", ["gltf", "glb"])
def test_a_reader_finds_the_sphere_and_its_material(name, tmp_path):
    path = tmp_path / f"material.{name}"
    export_estimate(GLOSSY_RED, name, path)
    (sphere,) = trimesh.load_scene(path).dump()
    np.testing.assert_allclose(sphere.bounds, [[-0.05] * 3, [0.05] * 3], atol=1e-6)
    sphere.merge_vertices()
    assert sphere.is_watertight
    # A positive volume: the triangles face outwards. 32 x 64 facets lose half a percent.
    assert sphere.volume == pytest.approx(4 / 3 * np.pi * 0.05**3, rel=0.01)
    material = sphere.visual.material
    assert material.metallicFactor == 0
    assert material.roughnessFactor == pytest.approx((0.7 * 0.09243) ** 0.5, abs=1e-4)


def test_the_json_holds_the_mapped_values(tmp_path):
    path = tmp_path / "material.gltf"
    export_estimate(GLOSSY_RED, "gltf", path)
    document = json.loads(path.read_text())
    assert document["asset"]["version"] == "2.0"
    (material,) = document["materials"]
    f0 = 0.2 * 0.6595
    base = material["pbrMetallicRoughness"]["baseColorFactor"]
    assert base == pytest.approx([0.4 / (1 - f0), 0.08 / (1 - f0), 0.04 / (1 - f0), 1.0])

    assert document["extensionsUsed"] == list(material["extensions"])
    specular = material["extensions"]["KHR_materials_specular"]
    for colour in specular["specularColorFactor"]:
        # KHR_materials_specular: F0 = min(0.04 colour, 1) factor, F90 = factor.
        assert min(0.04 * colour, 1) * specular["specularFactor"] == pytest.approx(f0)
    assert specular["specularFactor"] == pytest.approx(f0)


def test_the_file_says_where_it_comes_from(tmp_path):
    path = tmp_path / "material.gltf"
    export_estimate(GLOSSY_RED, "gltf", path)
    extras = json.loads(path.read_text())["materials"][0]["extras"]["reflest"]
    assert extras["model_id"] == GLOSSY_RED.model_id
    assert extras["ward_variant"] == "ward-1992"
    assert int(extras["stamp_ns"]) == GLOSSY_RED.stamp_ns
    assert (extras["rho_d"], extras["rho_s"], extras["alpha"]) == ([0.4, 0.08, 0.04], 0.2, 0.1)
    assert extras["status"] == "OK"


def test_a_scan_is_one_mesh_with_a_primitive_for_each_material(ball, tmp_path):
    path = tmp_path / "ball.gltf"
    export_asset(ball, path)
    document = json.loads(path.read_text())
    (mesh,) = document["meshes"]
    names = [document["materials"][one["material"]]["name"] for one in mesh["primitives"]]
    assert names == ["ball_material_7", "ball_material_3"]
    for primitive in mesh["primitives"]:
        assert {"POSITION", "NORMAL", "TEXCOORD_0", "_MATERIAL_ID", "_RHO_D_STDDEV"} <= set(
            primitive["attributes"]
        )
    extras = document["materials"][1]["extras"]["reflest"]
    assert extras["status_text"] == "the roughness is hardly known"
    assert document["materials"][0]["extras"]["reflest"]["rho_s_stddev"] == 0.02
    assert "rho_s_stddev" not in extras


@pytest.mark.parametrize("name", ["ball.gltf", "ball.glb"])
def test_all_materials_share_one_picture(ball, name, tmp_path):
    path = tmp_path / name
    export_asset(ball, path)
    if path.suffix == ".gltf":
        document = json.loads(path.read_text())
    else:
        content = path.read_bytes()
        document = json.loads(content[20 : 20 + int.from_bytes(content[12:16], "little")])
    assert (len(document["images"]), len(document["textures"])) == (1, 1)
    pbr = [one["pbrMetallicRoughness"] for one in document["materials"]]
    assert [one["baseColorTexture"] for one in pbr] == [{"index": 0}, {"index": 0}]


def test_the_scan_stands_upright_in_metres_with_its_texture(ball, tmp_path):
    path = tmp_path / "ball.glb"
    export_asset(ball, path)
    parts = trimesh.load_scene(path).dump()
    assert {one.name for one in tmp_path.iterdir()} == {"ball.glb", "ball_environment.hdr"}
    assert [part.visual.material.name for part in parts] == ["ball_material_7", "ball_material_3"]
    red, striped = parts
    # glTF has y up: the red upper half is above.
    assert red.vertices[:, 1].mean() > 0.03
    assert striped.vertices[:, 1].mean() < -0.03
    assert np.abs(np.linalg.norm(red.vertices, axis=1) - RADIUS).max() < VOXEL
    for part, index in ((red, 0), (striped, 1)):
        expected = ball.mesh.part(index)
        np.testing.assert_allclose(part.vertices[:, 0], expected.vertices[:, 0], atol=1e-6)
        np.testing.assert_allclose(part.vertices[:, 1], expected.vertices[:, 2], atol=1e-6)
        np.testing.assert_allclose(part.vertices[:, 2], -expected.vertices[:, 1], atol=1e-6)
        np.testing.assert_allclose(part.visual.uv, expected.uv, atol=1e-6)
        picture = np.asarray(part.visual.material.baseColorTexture.convert("RGB"))
        np.testing.assert_array_equal(picture, ball.base_colour)


@pytest.mark.parametrize("name", ["gltf", "glb"])
@pytest.mark.parametrize("what", ["sphere", "scan"])
def test_the_validator_of_khronos_finds_no_error_and_no_warning(ball, name, what, tmp_path):
    needs_node()
    path = tmp_path / f"asset.{name}"
    if what == "sphere":
        export_estimate(GLOSSY_RED, name, path)
    else:
        export_asset(ball, path)
    command = ["node", str(WEB / "validate_gltf.js"), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=600)
    report = json.loads(done.stdout)
    assert (report["numErrors"], report["numWarnings"], report["numHints"]) == (0, 0, 0), report
