# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Colours of other frames and jumps along a plane are found; right captures raise nothing."""

from dataclasses import replace

import numpy as np
import pytest

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.frame import Frame
from reflest_core.capture.open_capture import open_capture
from reflest_core.fusion.poses.agreement import DepthSample
from reflest_core.fusion.poses.check import PoseCheck
from reflest_core.fusion.poses.colour_agreement import ReducedImage
from reflest_core.fusion.poses.colours import PlacedFrame

CAMERA = CameraIntrinsics(width=160, height=120, fx=150.0, fy=150.0, cx=79.5, cy=59.5)
HEIGHT = 0.6
"""Metres from the camera to the plane."""
STEP = 0.004
"""Metres from frame to frame, along x."""
AT = 12
"""The first frame after a jump."""


def plane(count, texture, jump=0.0, contrast=60.0):
    """A camera that looks down on a plane and moves along it; its tracker jumps."""
    rows, columns = np.mgrid[: CAMERA.height, : CAMERA.width]
    frames = []
    for index in range(count):
        pose = np.diag([1.0, -1.0, -1.0, 1.0])
        pose[:3, 3] = index * STEP, 0.0, HEIGHT
        x = (columns - CAMERA.cx) / CAMERA.fx * HEIGHT + pose[0, 3]
        y = (CAMERA.cy - rows) / CAMERA.fy * HEIGHT
        grey = 120.0 + contrast * texture(x, y)
        told = pose.copy()
        told[0, 3] += jump if index >= AT else 0.0
        rgb = np.repeat(np.clip(grey, 0.0, 255.0).astype(np.uint8)[..., None], 3, axis=2)
        depth = np.full(rgb.shape[:2], HEIGHT, np.float32)
        frames.append(Frame(1 + index * 10**8, rgb, depth, told, CAMERA))
    return frames


def speckles(x, y):
    """A texture that nowhere repeats itself within the plane."""
    return (
        sum(
            np.sin(a * x + b * y + c)
            for a, b, c in ((210.0, 40.0, 0.0), (130.0, 170.0, 1.0), (-90.0, 190.0, 2.0))
        )
        / 3.0
    )


def uniform(x, y):
    return np.zeros_like(x)


def checked(frames):
    """The report, and the indices of the frames that confirm a jump."""
    check = PoseCheck()
    confirming = [index for index, frame in enumerate(frames) if check.add(frame) is not None]
    return check.report, confirming


def shuffled(frames, seed=0):
    order = np.random.default_rng(seed).permutation(len(frames))
    return [replace(frame, rgb=frames[k].rgb) for frame, k in zip(frames, order, strict=True)]


@pytest.fixture(scope="module", params=["captures/glossy-red", "captures/table"])
def frames(request):
    return list(open_capture(request.param))


def test_right_colours_meet_and_nothing_is_said(frames):
    report, confirming = checked(frames)
    assert report.colour_agreement > 0.7
    assert report.problem == ""
    assert confirming == []
    assert report.to_json()["colour_agreement"] == report.colour_agreement


def test_colours_of_other_frames_are_a_problem(frames):
    report, confirming = checked(shuffled(frames))
    assert abs(report.colour_agreement) < 0.1
    assert "come in no order" in report.problem
    assert confirming == []


def test_exposure_and_colour_of_the_light_do_not_matter(frames):
    gains = np.random.default_rng(1).uniform(0.5, 1.0, (len(frames), 3))
    dimmed = [
        replace(frame, rgb=(frame.rgb * gain).astype(np.uint8))
        for frame, gain in zip(frames, gains, strict=True)
    ]
    report, confirming = checked(dimmed)
    assert report.colour_agreement > 0.7
    assert report.problem == ""
    assert confirming == []


def test_a_jump_along_a_textured_plane_is_confirmed_by_the_frame_after_it():
    report, confirming = checked(plane(20, speckles, jump=0.1))
    assert report.agreement == 1.0  # depth shows nothing
    assert confirming == [AT + 1]
    assert "the tracker jumped once" in report.problem


def test_the_same_camera_without_a_jump_raises_nothing():
    report, confirming = checked(plane(20, speckles))
    assert report.colour_agreement > 0.95
    assert confirming == []
    assert report.problem == ""


def test_one_frame_of_wrong_colours_is_no_jump():
    frames = plane(20, speckles)
    frames[AT] = replace(frames[AT], rgb=frames[AT].rgb[::-1, ::-1].copy())
    assert checked(frames)[1] == []


@pytest.mark.parametrize("jump", [0.0, 0.1])
def test_a_plane_without_texture_says_nothing(jump):
    """Sensor noise is no texture: a jump along such a plane cannot be found."""
    noise = np.random.default_rng(2)
    noisy = [
        replace(
            frame,
            rgb=np.clip(frame.rgb + noise.normal(0.0, 4.0, frame.rgb.shape), 0, 255).astype(
                np.uint8
            ),
        )
        for frame in plane(20, uniform, jump)
    ]
    report, confirming = checked(noisy)
    assert np.isnan(report.colour_agreement)
    assert report.to_json()["colour_agreement"] is None
    assert confirming == []
    assert report.problem == ""


def test_after_a_restart_no_frame_is_compared_with_those_before():
    frames = plane(20, speckles, jump=0.1)
    check = PoseCheck()
    for index, frame in enumerate(frames):
        if index == AT:
            check.restart()
        assert check.add(frame) is None


@pytest.mark.parametrize("shape", [(4, 4), (1, 1), (3, 200), (481, 641)])
def test_images_of_any_size_are_reduced(shape):
    rgb = np.random.default_rng(3).integers(0, 256, (*shape, 3), np.uint8)
    image = ReducedImage.of(rgb)
    assert np.isfinite(image.detail).all()
    assert np.isfinite(image.thumbnail).all()
    assert abs(float(image.thumbnail.mean()) - rgb.mean()) < 40.0


def test_detail_of_an_even_image_is_nothing():
    image = ReducedImage.of(np.full((120, 160, 3), 77, np.uint8))
    np.testing.assert_allclose(image.detail, 0.0, atol=0.01)
    np.testing.assert_allclose(image.thumbnail, 77.0, atol=0.01)


def test_a_frame_meets_itself():
    frame = plane(1, speckles)[0]
    placed = PlacedFrame(frame, DepthSample(frame))
    found = placed.colours_meet(placed)
    assert found.correlation == pytest.approx(1.0, abs=1e-6)
    assert found.is_known
