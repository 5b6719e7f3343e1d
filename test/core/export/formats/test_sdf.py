# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The model keeps to SDFormat's schema; its meshes and textures are where it says."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
import trimesh

from reflest_core.export.exporter import export_asset, export_estimate
from reflest_core.export.scan_asset import AssetSettings, scan_asset
from test.core.export.estimates import GLOSSY_RED
from test.core.export.scanned_ball import scanned_ball

NAMED = ("model", "link", "visual", "collision")
REPEATED = ("link",)
"""Elements that may hold several children of one kind."""
CHILDREN = {
    "sdf": ({"model"}, set()),
    "model": ({"link"}, {"static", "pose", "self_collide"}),
    "link": (set(), {"visual", "collision", "inertial", "pose"}),
    "visual": ({"geometry"}, {"material", "pose", "cast_shadows", "transparency"}),
    "collision": ({"geometry"}, {"pose", "surface"}),
    "geometry": ({"mesh"}, set()),
    "mesh": ({"uri"}, {"submesh", "scale"}),
    "material": (set(), {"ambient", "diffuse", "specular", "emissive", "double_sided", "pbr"}),
    "pbr": (set(), {"metal", "specular"}),
    "metal": (set(), {"albedo_map", "roughness", "roughness_map", "metalness", "metalness_map"}),
}
"""Of the elements that are written, their required and optional children (sdformat.org/spec)."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ball")
    asset = scan_asset(*scanned_ball(), "ball", AssetSettings(faces=1000))
    export_asset(asset, folder / "ball.sdf")
    return folder


def test_the_model_has_a_visual_and_a_collision_for_each_material(folder):
    model = ElementTree.parse(folder / "ball.sdf").getroot().find("model")
    assert model.get("name") == "ball"
    assert model.findtext("static") == "true"
    link = model.find("link")
    assert [one.get("name") for one in link.findall("visual")] == [
        "ball_material_7_visual",
        "ball_material_3_visual",
    ]
    assert len(link.findall("collision")) == 2
    metal = link.find("visual/material/pbr/metal")
    assert metal.findtext("metalness") == "0"
    assert float(metal.findtext("roughness")) == pytest.approx((0.7 * 0.09243) ** 0.5, abs=1e-4)
    assert (folder / metal.findtext("albedo_map")).is_file()


def test_the_meshes_are_the_surface_z_up(folder):
    root = ElementTree.parse(folder / "ball.sdf").getroot()
    uris = [one.text for one in root.findall(".//visual/geometry/mesh/uri")]
    red, striped = (trimesh.load_mesh(folder / uri, process=False) for uri in uris)
    assert red.vertices[:, 2].mean() > 0.03
    assert striped.vertices[:, 2].mean() < -0.03
    assert np.abs(np.linalg.norm(red.vertices, axis=1) - 0.1).max() < 0.008
    assert red.visual.uv.shape == (len(red.vertices), 2)


def test_the_model_is_found_by_its_config(folder):
    config = ElementTree.parse(folder / "model.config").getroot()
    assert config.findtext("sdf") == "ball.sdf"
    assert config.findtext("name") == "ball"


@pytest.mark.parametrize("what", ["ball", "sphere"])
def test_every_element_is_where_sdformat_1_9_has_it(folder, what, tmp_path):
    path = folder / "ball.sdf"
    if what == "sphere":
        path = tmp_path / "material.sdf"
        export_estimate(GLOSSY_RED, "sdf", path)
    root = ElementTree.parse(path).getroot()
    assert (root.tag, root.get("version")) == ("sdf", "1.9")
    names = [one.get("name") for one in root.iter() if one.tag in NAMED]
    assert all(names)
    assert len(set(names)) == len(names)
    waiting = [root]
    while waiting:
        element = waiting.pop()
        children = [one.tag for one in element if isinstance(one.tag, str)]
        required, allowed = CHILDREN.get(element.tag, (set(), set()))
        assert required <= set(children), element.tag
        assert set(children) <= required | allowed, element.tag
        if element.tag not in REPEATED:
            assert len(set(children)) == len(children), element.tag
        waiting += [one for one in element if isinstance(one.tag, str)]
    for colour in root.iter("diffuse"):
        values = [float(value) for value in colour.text.split()]
        assert len(values) == 4
        assert all(0 <= value <= 1 for value in values)
