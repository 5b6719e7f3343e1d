# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light's files as other programs read them: the values, and where a lamp comes from."""

import json

import cv2
import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.environment.environment_map import environment_map
from reflest_core.export.environment_file import LIGHT_FORMATS, export_environment, light_format
from reflest_core.export.errors import ExportError
from reflest_core.export.exporter import export_estimate
from reflest_core.light.light_map import LightMap
from reflest_core.synbrdf.path_tracing.ward_bsdf import mi
from test.core.export.complaints import complaints
from test.core.export.estimates import GLOSSY_RED, glossy_red
from test.core.export.lights import LAMP, around, lamp_towards
from test.web.browser import shown

TOWARDS = ((0.3, -0.8, 0.5), (0.0, 1.0, 0.2), (-1.0, 0.1, -0.3), (0.9, 0.0, 0.0))


@pytest.fixture
def written(tmp_path):
    """Write a light in a format; return the path."""

    def write(name, light):
        path = tmp_path / f"light{LIGHT_FORMATS[name]}"
        export_environment(around(light), name, path)
        return path

    return write


def test_opencv_reads_the_hdr_file(written):
    light = lamp_towards(TOWARDS[0])
    read = cv2.imread(str(written("hdr", light)), cv2.IMREAD_UNCHANGED)[..., ::-1]
    expected = environment_map(around(light)).radiance
    assert read.shape == expected.shape == (128, 256, 3)
    # Eight bits beside an exponent that the brightest channel sets.
    step = expected.max(axis=-1, keepdims=True) / 128
    assert (np.abs(read - expected) <= step).all()


def test_mitsuba_reads_the_exr_file_to_the_bit(written):
    light = lamp_towards(TOWARDS[0])
    bitmap = mi.Bitmap(str(written("exr", light)))
    expected = environment_map(around(light))
    assert bitmap.pixel_format() == mi.Bitmap.PixelFormat.RGBA
    read = np.array(bitmap)
    np.testing.assert_array_equal(read[..., :3], expected.radiance)
    np.testing.assert_array_equal(read[..., 3], expected.coverage)
    assert "+z" in bitmap.metadata()["comments"]


@pytest.mark.parametrize("format_name", LIGHT_FORMATS)
@pytest.mark.parametrize("towards", TOWARDS)
def test_mitsuba_sees_the_lamp_where_it_is(written, tmp_path, format_name, towards):
    """In the scene that the material's export writes around that light."""
    light_file = written(format_name, lamp_towards(towards))
    scene_file = tmp_path / "scene.xml"
    export_estimate(GLOSSY_RED, "mitsuba-stock", scene_file, light_file)
    assert light_file.name in scene_file.read_text()
    assert str(tmp_path) not in scene_file.read_text()
    scene = mi.load_file(str(scene_file))
    unit = np.array(towards) / np.linalg.norm(towards)
    assert seen_from_beside_the_sphere(scene, unit) == pytest.approx(LAMP, rel=0.02)
    # Neither mirrored nor turned by a quarter.
    for other in (-unit, unit * [1, -1, 1] + [0.2, 0, 0], np.roll(unit, 1), np.roll(unit, 2)):
        if other @ unit < 0.9 * np.linalg.norm(other):
            assert seen_from_beside_the_sphere(scene, other).max() < 0.5


def seen_from_beside_the_sphere(scene, direction):
    """What a ray from beyond the unit sphere meets, looking outwards along ``direction``."""
    unit = np.asarray(direction) / np.linalg.norm(direction)
    ray = mi.Ray3f((2.0 * unit).tolist(), unit.tolist())
    hit = scene.ray_intersect(ray)
    return np.array(hit.emitter(scene).eval(hit)).ravel()


def test_a_rendered_sphere_is_bright_towards_the_lamp(written, tmp_path):
    towards = np.array([0.5, -0.6, 0.6])
    light_file = written("hdr", lamp_towards(towards, 20.0))
    path = tmp_path / "scene.xml"
    export_estimate(glossy_red(rho_s=0.0), "mitsuba-stock", path, light_file)
    image = np.array(mi.render(mi.load_file(str(path)), spp=64))[..., 0]
    row, column = np.mgrid[-127.5:128, -127.5:128] / 128 * np.tan(np.radians(15))
    # Normals of the unit sphere's pixels, seen from 4.5 away: the near root of the ray's quadratic.
    rays = np.stack([column, np.ones_like(row), -row], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    along = 4.5 * rays[..., 1]
    root = along**2 - (4.5**2 - 1)
    is_hit = root > 0.02
    points = rays * (along - np.sqrt(np.maximum(root, 0)))[..., None] - [0, 4.5, 0]
    cosine = points @ (towards / np.linalg.norm(towards))
    assert np.corrcoef(np.maximum(cosine[is_hit], 0), image[is_hit])[0, 1] > 0.98


def test_usd_refers_to_the_light(written, tmp_path):
    from pxr import Usd, UsdLux

    (tmp_path / "lights").mkdir()
    light_file = tmp_path / "lights" / "room @ night.hdr"
    export_environment(around(lamp_towards(TOWARDS[0])), "hdr", light_file)
    path = tmp_path / "material.usda"
    export_estimate(GLOSSY_RED, "usd", path, light_file)
    stage = Usd.Stage.Open(str(path))
    dome = UsdLux.DomeLight(stage.GetPrimAtPath("/reflest/environment"))
    asset = dome.GetTextureFileAttr().Get()
    assert asset.path == "./lights/room @ night.hdr"
    assert asset.resolvedPath == str(light_file.resolve())
    assert dome.GetTextureFormatAttr().Get() == UsdLux.Tokens.latlong
    assert complaints(stage) == []


def test_without_light_there_is_no_dome(tmp_path):
    export_estimate(GLOSSY_RED, "usd", tmp_path / "material.usda")
    assert "DomeLight" not in (tmp_path / "material.usda").read_text()


def test_ply_has_no_environment_light(written, tmp_path):
    light_file = written("hdr", lamp_towards(TOWARDS[0]))
    with pytest.raises(ExportError, match="ply has no environment light"):
        export_estimate(GLOSSY_RED, "ply", tmp_path / "a.ply", light_file)


def test_three_js_lights_the_glb_by_the_file_that_its_scene_names(written, tmp_path):
    towards = np.array([0.5, -0.6, 0.6])
    light_file = written("hdr", lamp_towards(towards, 20.0))
    export_estimate(glossy_red(rho_s=0.0), "gltf", tmp_path / "sphere.gltf", light_file)
    document = json.loads((tmp_path / "sphere.gltf").read_text())
    name = document["scenes"][0]["extras"]["reflest"]["environment"]
    assert (tmp_path / name).is_file()
    picture = shown(
        "view_glb.html",
        tmp_path,
        tmp_path / "three.png",
        file="files/sphere.gltf",
        size=96,
        half=0.05 / 0.95,
        environment=f"files/{name}",
    )
    across = (np.arange(96) + 0.5) / 48 - 1
    right, down = np.meshgrid(across / 0.95, across / 0.95)
    is_sphere = right**2 + down**2 < 0.9
    normals = np.stack([right, -np.sqrt(np.clip(1 - right**2 - down**2, 0, 1)), -down], axis=-1)
    cosine = np.maximum(normals @ (towards / np.linalg.norm(towards)), 0)[is_sphere]
    assert np.corrcoef(cosine, srgb.decode(picture[..., 0])[is_sphere])[0, 1] > 0.98


def test_a_light_file_that_is_missing_is_named(tmp_path):
    with pytest.raises(ExportError, match=r"there is no environment file .*nothing\.hdr"):
        export_estimate(GLOSSY_RED, "usd", tmp_path / "a.usda", tmp_path / "nothing.hdr")


def test_light_that_nobody_saw_is_not_written(tmp_path):
    path = tmp_path / "light.hdr"
    for light in (None, LightMap().observed()):
        with pytest.raises(ExportError, match="no light around the object was seen"):
            export_environment(around(light), "hdr", path)
    assert not path.exists()


def test_a_suffix_of_no_light_is_refused(tmp_path):
    with pytest.raises(ExportError, match=r"must end in \.hdr for the format hdr"):
        export_environment(around(lamp_towards(TOWARDS[0])), "hdr", tmp_path / "light.exr")
    with pytest.raises(ExportError, match=r"must end in \.hdr or \.exr"):
        light_format(tmp_path / "light.png")
