# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""SDFormat's own library reads the model; its meshes and textures are where it says."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
import trimesh

from reflest_core.export.exporter import export_asset, export_estimate
from reflest_core.export.scan_asset import AssetSettings, scan_asset
from test.core.export.estimates import GLOSSY_RED
from test.core.export.scanned_ball import scanned_ball


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
    assert float(metal.findtext("roughness")) == pytest.approx((0.88 * 0.09243) ** 0.5, abs=1e-4)
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
def test_sdformat_reads_it_without_a_complaint(folder, what, tmp_path):
    sdformat = pytest.importorskip(
        "sdformat14.sdformat", reason="needs sdformat14-py-bindings", exc_type=ImportError
    )
    path = folder / "ball.sdf"
    if what == "sphere":
        path = tmp_path / "material.sdf"
        export_estimate(GLOSSY_RED, "sdf", path)
    root = sdformat.Root()
    assert not root.load(str(path))
    model = root.model()
    assert model.static()
    assert model.link_by_index(0).visual_count() == (2 if what == "ball" else 1)
