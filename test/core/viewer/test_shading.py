# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Lights to show a scan in, and the model in them."""

import numpy as np
import pytest

from reflest_core.errors import ReflestError
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.viewer.lights import (
    Light,
    invented_light,
    octahedral_light,
    read_light,
    turned_pyramid,
)
from reflest_core.viewer.shading import Shading, displayed
from reflest_core.viewer.shown_scan import ShownScan
from test.core.export.scanned_ball import RED_ID, scanned_ball


@pytest.fixture(scope="module")
def shading():
    return Shading(ShownScan.of(*scanned_ball(), (0.0, 0.0, 1.0)))


def brightest(level):
    return octahedral_directions(len(level)).reshape(-1, 3)[
        level.reshape(-1, 5)[:, :3].sum(axis=1).argmax()
    ]


def test_a_turned_light_comes_from_the_turned_direction():
    light = octahedral_light(invented_light(Light.LAMP))
    x, y, z = brightest(turned_pyramid(light, 0.0).levels[1])
    turned = brightest(turned_pyramid(light, 90.0).levels[1])
    assert turned == pytest.approx([-y, x, z], abs=0.1)


def test_a_lamp_lights_the_side_that_faces_it_most(shading):
    light = shading.light(Light.LAMP)
    towards = brightest(light.levels[1])
    diffuse = shading.diffuse(light)
    albedo = shading.scan.rho_d
    irradiance = (diffuse / albedo).mean(axis=1)
    cosine = shading.scan.normals @ towards
    assert irradiance[cosine > 0.9].min() > 3 * irradiance[cosine < -0.5].max()


def test_other_lights_are_as_bright_in_the_mean(shading):
    means = [
        np.nanmean(shading.diffuse(shading.light(light)) / shading.scan.rho_d)
        for light in (Light.STUDIO, Light.LAMP, Light.OVERCAST)
    ]
    assert means == pytest.approx([means[0]] * 3, rel=0.05)


def test_the_highlight_is_where_the_lamp_is_mirrored(shading):
    light = shading.light(Light.LAMP)
    eye = np.array([0.4, -0.4, 0.5])
    glossy = shading.mirrored(light, eye)[:, 0]
    half = eye / np.linalg.norm(eye) + brightest(light.levels[1])
    half /= np.linalg.norm(half)
    scan = shading.scan
    bright = glossy > 0.5 * glossy.max()
    assert (scan.normals[bright] @ half).min() > 0.95
    vertex = int(glossy.argmax())
    alone = shading.towards(light, vertex, eye[None])[0, 0]
    assert alone == pytest.approx(shading.diffuse(light)[vertex, 0] + glossy[vertex], rel=1e-5)
    assert scan.material_at(vertex).id == RED_ID


def test_each_stop_doubles_and_unknown_is_grey():
    radiance = np.array([[0.1, 0.2, 0.3], [np.nan] * 3], np.float32)
    assert displayed(radiance, 1.0)[0] == pytest.approx(displayed(2 * radiance, 0.0)[0])
    assert displayed(radiance)[1].tolist() == [96, 96, 96]


@pytest.mark.parametrize("name", ["missing.hdr", "text.hdr"])
def test_a_light_that_cannot_be_read_is_named_in_one_sentence(tmp_path, name):
    (tmp_path / "text.hdr").write_text("not an image")
    with pytest.raises(ReflestError, match=name):
        read_light(tmp_path / name)
