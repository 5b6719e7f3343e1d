# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The asset of a scanned ball: its surface, its materials, its texture."""

import dataclasses

import numpy as np
import pytest
import trimesh

from reflest_core.brdf import srgb
from reflest_core.export.bake import covered_texels
from reflest_core.export.errors import ExportError
from reflest_core.export.microfacet_material import MicrofacetMaterial
from reflest_core.export.scan_asset import AssetSettings, scan_asset
from reflest_core.export.scanned_mesh import check_closed
from reflest_core.export.triangle_mesh import TriangleMesh
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.inference.light import SceneLight
from reflest_core.light.completion import LightPyramid
from test.core.export.scanned_ball import (
    BRIGHT,
    DARK,
    RADIUS,
    RED_ID,
    STRIPE,
    STRIPED_ID,
    VOXEL,
    scanned_ball,
    without_albedo,
)


@pytest.fixture(scope="module")
def asset():
    return scan_asset(*scanned_ball(), "ball", AssetSettings(faces=3000))


def test_the_mesh_lies_on_the_ball_and_faces_outwards(asset):
    mesh = asset.mesh
    distances = np.linalg.norm(mesh.vertices, axis=1)
    assert np.abs(distances - RADIUS).max() < VOXEL
    assert np.abs(distances - RADIUS).mean() < VOXEL / 5
    corners = mesh.vertices[mesh.faces]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.sum(facing * corners.mean(axis=1), axis=1) > 0).mean() > 0.999
    cosines = np.sum(mesh.normals * mesh.vertices, axis=1) / distances
    assert np.percentile(cosines, 5) > 0.95
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-5)


def test_the_mesh_has_as_many_faces_as_were_asked_for(asset):
    assert 2700 <= len(asset.mesh.faces) <= 3000
    small = scan_asset(*scanned_ball(), "ball", AssetSettings(faces=500))
    assert 400 <= len(small.mesh.faces) <= 500


def test_each_face_has_the_material_of_the_voxels_there(asset):
    assert [one.facts["material_id"] for one in asset.materials] == [RED_ID, STRIPED_ID]
    middles = asset.mesh.vertices[asset.mesh.faces].mean(axis=1)
    is_clear = np.abs(middles[:, 2]) > 2 * VOXEL
    is_red = asset.mesh.face_materials == 0
    assert (is_red == (middles[:, 2] > 0))[is_clear].all()
    ids = asset.mesh.attributes["material_id"][asset.mesh.faces]
    assert (ids == np.where(is_red, RED_ID, STRIPED_ID)[:, None]).all()


def test_a_vertex_belongs_to_one_material_alone(asset):
    of_red = np.unique(asset.mesh.faces[asset.mesh.face_materials == 0])
    of_striped = np.unique(asset.mesh.faces[asset.mesh.face_materials == 1])
    assert not np.isin(of_red, of_striped).any()


def texels_with_places(asset):
    size = len(asset.base_colour)
    texels, face, weights = covered_texels(asset.mesh.uv, asset.mesh.faces, size)
    places = np.einsum("tk,tkc->tc", weights, asset.mesh.vertices[asset.mesh.faces[face]])
    return srgb.decode(asset.base_colour.reshape(-1, 3)[texels] / 255), face, places


def test_the_texture_shows_each_voxels_albedo_where_it_is(asset):
    colours, face, places = texels_with_places(asset)
    striped = asset.materials[1]
    f0 = MicrofacetMaterial.from_ward(striped.ward).f0
    stripe = (places[:, 0] / STRIPE) % 2
    is_striped = (asset.mesh.face_materials[face] == 1) & (places[:, 2] < -VOXEL)
    for expected, middle in ((BRIGHT, 0.5), (DARK, 1.5)):
        is_middle = is_striped & (np.abs(stripe - middle) < 0.2)
        assert is_middle.sum() > 500
        found = np.median(colours[is_middle], axis=0)
        np.testing.assert_allclose(found, expected / (1 - f0), rtol=0.03)


def test_colours_do_not_bleed_from_one_material_into_the_other(asset):
    colours, face, _ = texels_with_places(asset)
    expected = MicrofacetMaterial.from_ward(asset.materials[0].ward).base_colour
    of_red = colours[asset.mesh.face_materials[face] == 0]
    assert np.abs(of_red - expected).max() < 0.01


def test_every_part_of_the_surface_has_texels_of_its_own(asset):
    size = len(asset.base_colour)
    texels, face, _ = covered_texels(asset.mesh.uv, asset.mesh.faces, size)
    corners = asset.mesh.vertices[asset.mesh.faces]
    areas = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    # On average about two texels for each voxel, along each direction; none is used twice, but for
    # edges of faces that pass through a texel's very centre.
    assert len(texels) > 1.5 * areas.sum() / (VOXEL / 2) ** 2 / 2
    assert len(np.unique(texels)) > 0.995 * len(texels)
    per_area = np.bincount(face, minlength=len(areas)).sum() / areas.sum()
    large = areas > np.percentile(areas, 70)
    counts = np.bincount(face, minlength=len(areas))[large] / areas[large]
    assert np.percentile(counts, 5) > 0.35 * per_area


def test_unknown_albedo_is_the_materials():
    asset = scan_asset(*without_albedo(), "ball", AssetSettings(faces=500))
    colours, face, _ = texels_with_places(asset)
    for index, material in enumerate(asset.materials):
        expected = MicrofacetMaterial.from_ward(material.ward).base_colour
        assert np.abs(colours[asset.mesh.face_materials[face] == index] - expected).max() < 0.01


def test_deviations_travel_as_attributes_and_unknown_ones_are_negative(asset):
    ids = asset.mesh.attributes["material_id"]
    rho_s = asset.mesh.attributes["rho_s_stddev"]
    assert np.unique(rho_s[ids == RED_ID]).tolist() == [np.float32(0.02)]
    assert np.unique(rho_s[ids == STRIPED_ID]).tolist() == [-1.0]
    np.testing.assert_allclose(asset.mesh.attributes["rho_d_stddev"], 0.05)


def test_a_doubtful_estimate_is_named_in_one_sentence(asset):
    assert asset.warning == (
        "1 of 2 materials has a doubtful estimate: ball_material_3 (UNCERTAIN_GLOSS)"
    )
    (doubtful,) = (one for one in asset.materials if one.status != "OK")
    alone = dataclasses.replace(asset, materials=(doubtful,))
    assert alone.warning.startswith("the material has a doubtful estimate: ball_material_3")


def test_a_file_called_material_does_not_repeat_the_word():
    named = scan_asset(*scanned_ball(), "red_material", AssetSettings(faces=500))
    assert [one.name for one in named.materials] == ["red_material_7", "red_material_3"]


def test_the_light_is_the_one_that_the_materials_were_estimated_in():
    scan, found = scanned_ball()
    level = np.zeros((96, 96, 5), np.float32)
    level[..., :3] = [0.5, 1.0, 2.0]
    pyramid = LightPyramid([level], np.zeros((96, 96, 3), np.float32))
    light = SceneLight(found.surface.light, pyramid, pyramid, None, {}, {})
    asset = scan_asset(
        scan, dataclasses.replace(found, light=light), "ball", AssetSettings(faces=500)
    )
    np.testing.assert_allclose(asset.light.radiance, np.broadcast_to([0.5, 1, 2], (128, 256, 3)))


def test_the_same_scan_gives_the_same_asset(asset):
    again = scan_asset(*scanned_ball(), "ball", AssetSettings(faces=3000))
    np.testing.assert_array_equal(again.mesh.vertices, asset.mesh.vertices)
    np.testing.assert_array_equal(again.mesh.faces, asset.mesh.faces)
    np.testing.assert_array_equal(again.base_colour, asset.base_colour)


def test_a_watertight_surface_is_closed():
    asset = scan_asset(*scanned_ball(), "ball", AssetSettings(faces=2000, is_watertight=True))
    mesh = trimesh.Trimesh(asset.mesh.vertices, asset.mesh.faces, process=False)
    mesh.merge_vertices(merge_norm=True, merge_tex=True)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * RADIUS**3, rel=0.05)


def test_an_open_surface_cannot_be_closed():
    edge = np.arange(-0.2, 0.2, 0.005)
    places = np.stack(np.meshgrid(edge, edge, [0.0]), axis=-1).reshape(-1, 3).astype(np.float32)
    bubble = trimesh.creation.uv_sphere(0.4)
    closed = TriangleMesh(bubble.vertices.astype(np.float32), bubble.faces.astype(np.int32))
    with pytest.raises(ExportError, match="is an open surface, such as a wall"):
        check_closed(closed, places)
    with pytest.raises(ExportError, match="is an open surface, such as a wall"):
        check_closed(closed.kept(np.arange(len(closed.faces)) > 9), bubble.vertices)
    check_closed(closed, bubble.vertices)


def test_up_is_up_in_the_asset(asset):
    lying = scan_asset(*scanned_ball(), "ball", AssetSettings(faces=3000, up=(1.0, 0.0, 0.0)))
    is_red = np.unique(lying.mesh.faces[lying.mesh.face_materials == 0])
    # The world's +z, where red is, lies where the shortest turn from +x to +z takes it: -x.
    assert lying.mesh.vertices[is_red, 0].mean() < -0.02
    assert abs(lying.mesh.vertices[is_red, 2].mean()) < 0.01


def test_what_cannot_be_exported_is_said():
    scan, found = scanned_ball()
    empty = Scan(FusionSettings(), RegionSettings())
    with pytest.raises(ExportError, match="nothing was scanned"):
        scan_asset(empty, found, "ball")
    with pytest.raises(ExportError, match="no material with an estimate"):
        scan_asset(scan, dataclasses.replace(found, materials=()), "ball")
    with pytest.raises(ExportError, match="faces is 2"):
        AssetSettings(faces=2)
    with pytest.raises(ExportError, match="texture size 9"):
        AssetSettings(texture_size=9)
    with pytest.raises(ExportError, match="it must be a direction"):
        AssetSettings(up=(0.0, 0.0, 0.0))
