# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan far from the world's origin lies there in every format, to a tenth of a millimetre."""

import dataclasses
import json
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from plyfile import PlyData
from pxr import Usd, UsdGeom

from reflest_core.export.exporter import export_asset
from reflest_core.export.scan_asset import AssetSettings, scan_asset
from test.core.export.scanned_ball import scanned_ball

UTM = np.array([500_123.0, 4_600_321.0, 211.0])


@pytest.fixture(scope="module")
def far_map():
    scan, found = scanned_ball()
    return scan, dataclasses.replace(found, surface=dataclasses.replace(found.surface, origin=UTM))


@pytest.fixture(scope="module")
def ball(far_map):
    return scan_asset(*far_map, "ball", AssetSettings(faces=500))


def corners(points):
    return np.stack([points.min(axis=0), points.max(axis=0)])


def obj_corners(path):
    lines = [line.split()[1:] for line in path.read_text().splitlines() if line.startswith("v ")]
    return corners(np.array(lines, np.float64))


def ply_corners(path):
    vertices = PlyData.read(path)["vertex"]
    return corners(np.stack([vertices[axis] for axis in "xyz"], axis=1))


def usd_corners(path):
    stage = Usd.Stage.Open(str(path))
    bounds = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    mesh = next(prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh))
    box = bounds.ComputeWorldBound(mesh).ComputeAlignedRange()
    return np.array([box.GetMin(), box.GetMax()])


def gltf_corners(path):
    """glTF has y up: x, z, -y of the world."""
    tree = json.loads(path.read_text())
    (node,) = tree["nodes"]
    places = [one["attributes"]["POSITION"] for one in tree["meshes"][0]["primitives"]]
    ends = [tree["accessors"][one][end] for one in places for end in ("min", "max")]
    x, y, z = (np.array(ends, np.float64) + node["translation"]).T
    return corners(np.stack([x, -z, y], axis=1))


def sdf_corners(path):
    model = ElementTree.parse(path).getroot().find("model")
    place = np.array(model.findtext("pose").split(), np.float64)
    assert place[3:].tolist() == [0.0, 0.0, 0.0]
    meshes = [obj_corners(path.with_name(uri.text)) for uri in model.iter("uri")]
    return corners(np.concatenate(meshes)) + place[:3]


@pytest.mark.parametrize(
    ("format_name", "name", "read"),
    [
        ("obj", "ball.obj", obj_corners),
        ("ply", "ball.ply", ply_corners),
        ("usd", "ball.usda", usd_corners),
        ("gltf", "ball.gltf", gltf_corners),
        ("sdf", "ball.sdf", sdf_corners),
    ],
)
def test_a_file_places_the_mesh_in_the_world(ball, tmp_path, format_name, name, read):
    export_asset(ball, tmp_path / name, format_name)
    expected = corners(ball.mesh.vertices.astype(np.float64)) + UTM
    np.testing.assert_allclose(read(tmp_path / name), expected, atol=1e-4)


def test_up_turns_the_origin_as_it_turns_the_mesh(far_map):
    turned = scan_asset(*far_map, "ball", AssetSettings(faces=500, up=(0.0, 1.0, 0.0)))
    x, y, z = UTM
    np.testing.assert_allclose(turned.origin, [x, -z, y], atol=1e-6)
