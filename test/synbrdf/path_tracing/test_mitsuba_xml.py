# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes as Mitsuba files show what our own renderer shows."""

import cv2
import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.cli.main import main
from reflest_core.light.environment_reader import read_radiance
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.path_tracing.full_image import FullImageRenderer
from reflest_core.synbrdf.path_tracing.mitsuba_scene import (
    RadianceTracer,
    first_hits,
    mi,
    mitsuba_scene,
)
from reflest_core.synbrdf.path_tracing.sight import camera_rays
from reflest_core.synbrdf.path_tracing.ward_bsdf import ward_bsdf
from reflest_core.synbrdf.scenes.splits import Split
from reflest_core.synbrdf.scenes.views import depth_camera

GENERATION = Generation(3, {"train": 10, "validation": 4, "unseen": 4}, views=8)
CAMERA = depth_camera(96, 72)
OPTIONS = ["--seed", "3", "--train", "10", "--validation", "4", "--unseen", "4", "--views", "8"]
OPTIONS += ["--width", "96", "--height", "72"]


@pytest.fixture(scope="module")
def scene():
    return GENERATION.scene(Split.TRAIN, 1)


@pytest.fixture(scope="module")
def rendered(scene):
    return mitsuba_scene(scene.mesh, ward_bsdf(scene.painted.dominant.ward), scene.light.radiance)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("xml")
    words = ["--out", str(out), "--scenes", "1", "--frames", "0:8:5", "--samples", "64"]
    assert main(["synbrdf", "xml", *words, *OPTIONS]) == 0
    return out / "train-00001"


def test_a_ray_returns_the_same_light_from_file_and_memory(folder, scene, rendered):
    loaded = mi.load_file(str(folder / "scene.xml"))
    origins, directions = camera_rays(CAMERA, scene.poses[[5]])
    np.testing.assert_array_equal(
        first_hits(loaded, origins, directions), first_hits(rendered, origins, directions)
    )
    tracer = RadianceTracer(16, lanes=1 << 17)
    ours = tracer.trace(rendered, origins, directions, seed=4)
    theirs = tracer.trace(loaded, origins, directions, seed=4)
    np.testing.assert_allclose(theirs, ours, rtol=1e-4, atol=1e-5)


def test_its_sensors_see_what_our_camera_sees(folder, scene, rendered, tmp_path):
    """View 5 is the second sensor. Mitsuba samples a pixel's square, and nothing is denoised."""
    out = tmp_path / "image.exr"
    arguments = [str(folder / "scene.xml"), "--sensor", "1", "--samples", "256"]
    assert main(["synbrdf", "render", *arguments, "--out", str(out)]) == 0
    theirs = read_radiance(out).radiance
    image = FullImageRenderer(CAMERA, 256).render(
        rendered, scene.light.radiance, scene.poses[5], seed=1
    )
    assert theirs.shape == image.radiance.shape
    # Blurred, so that neither noise nor outlines count but what stands where does.
    error = np.abs(blurred(theirs) - blurred(image.radiance)) / (blurred(image.radiance) + 0.05)
    mirrored = np.abs(blurred(theirs[:, ::-1]) - blurred(image.radiance))
    assert np.median(error) < 0.01
    assert np.quantile(error, 0.99) < 0.08
    assert np.median(mirrored / (blurred(image.radiance) + 0.05)) > 0.05


def blurred(radiance):
    return cv2.blur(radiance, (5, 5))


def test_a_room_is_refused_in_one_sentence(tmp_path, capsys):
    out = ["--out", str(tmp_path / "xml"), "--scenes", "0", "--frames", "0", "--lighting", "near"]
    assert main(["synbrdf", "xml", *out, *OPTIONS]) == 2
    printed = capsys.readouterr().err.strip()
    assert printed.startswith("reflest: error: train-00000 stands in a room")
    assert len(printed.splitlines()) == 1


def test_a_file_that_cannot_be_rendered_is_one_sentence(folder, tmp_path, capsys):
    broken = tmp_path / "scene.xml"
    broken.write_text("<scene version='3.0.0'><bsdf type='nonesuch'/></scene>")
    out = ["--out", str(tmp_path / "image.exr")]
    for scene, reason in (
        ([str(tmp_path / "none.xml")], "there is no Mitsuba scene"),
        ([str(broken)], "cannot be loaded"),
        ([str(folder / "scene.xml"), "--sensor", "2"], "--sensor must be 0 to 1"),
    ):
        assert main(["synbrdf", "render", *scene, *out]) == 2
        printed = capsys.readouterr().err.strip()
        assert printed.startswith("reflest: error:")
        assert reason in printed
        assert len(printed.splitlines()) == 1
