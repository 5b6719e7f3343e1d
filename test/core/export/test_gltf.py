# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Trimesh reads what was written; the extension's values mean what the specification says."""

import json

import numpy as np
import pytest
import trimesh

from reflest_core.export.material_file import export_estimate
from reflest_core.export.sphere_mesh import sphere_mesh
from test.core.export.estimates import GLOSSY_RED


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
    assert material.roughnessFactor == pytest.approx(0.09243**0.5, abs=1e-4)


def test_the_json_holds_the_mapped_values(tmp_path):
    path = tmp_path / "material.gltf"
    export_estimate(GLOSSY_RED, "gltf", path)
    document = json.loads(path.read_text())
    assert document["asset"]["version"] == "2.0"
    (material,) = document["materials"]
    base = material["pbrMetallicRoughness"]["baseColorFactor"]
    assert base == pytest.approx([0.5, 0.1, 0.05, 1.0])

    assert document["extensionsUsed"] == list(material["extensions"])
    specular = material["extensions"]["KHR_materials_specular"]
    for colour in specular["specularColorFactor"]:
        # KHR_materials_specular: F0 = min(0.04 colour, 1) factor, F90 = factor.
        assert min(0.04 * colour, 1) * specular["specularFactor"] == pytest.approx(0.2)
    assert specular["specularFactor"] == pytest.approx(0.2)


def test_the_file_says_where_it_comes_from(tmp_path):
    path = tmp_path / "material.gltf"
    export_estimate(GLOSSY_RED, "gltf", path)
    extras = json.loads(path.read_text())["materials"][0]["extras"]["reflest"]
    assert extras["model_id"] == GLOSSY_RED.model_id
    assert extras["ward_variant"] == "ward-1992"
    assert int(extras["stamp_ns"]) == GLOSSY_RED.stamp_ns
    assert (extras["rho_d"], extras["rho_s"], extras["alpha"]) == ([0.4, 0.08, 0.04], 0.2, 0.1)


def test_normals_are_unit_and_every_triangle_faces_outwards():
    normals, triangles = sphere_mesh()
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-6)
    first, second, third = (normals[triangles[:, k]] for k in range(3))
    facing = np.cross(second - first, third - first)
    assert np.all(np.sum(facing * (first + second + third), axis=1) > 0)
