# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Background pixels: which, of what colour, and in which direction the object sees them."""

import dataclasses

import numpy as np
import pytest

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.frame import Frame
from reflest_core.capture.refusal import FrameRefused
from reflest_core.fusion.frames.background_light import (
    ACROSS,
    MARGIN,
    background_pixels,
    without_holes,
)
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.light.light_map import LONGEST_MEMORY, SIZE, LightMap
from reflest_core.light.octahedral import octahedral_directions
from test.core.fusion.analytic_scene import OBJECT, look_at, orbit, orbit_frames, render

CAMERA = CameraIntrinsics(64, 48, 50.0, 50.0, 31.5, 23.5)


@pytest.fixture
def frame():
    rng = np.random.default_rng(0)
    pose = np.eye(4)
    pose[:3, 3] = [0.5, -0.2, 1.0]
    return Frame(
        stamp_ns=1,
        frame_id="camera",
        rgb=rng.integers(0, 256, (48, 64, 3), np.uint8),
        depth=np.zeros((48, 64), np.float32),
        intrinsics=CAMERA,
        T_world_camera=pose,
    )


def test_what_has_no_depth_lies_along_its_ray(frame):
    nothing = np.zeros((48, 64), np.bool_)
    directions, colours = background_pixels(frame, nothing, frame.depth, np.zeros(3))
    assert len(directions) == 48 * 64
    np.testing.assert_allclose(directions[5 * 64 + 7], [(7 - 31.5) / 50, (5 - 23.5) / 50, 1.0])
    np.testing.assert_array_equal(colours, frame.rgb.reshape(-1, 3))


def test_what_has_depth_is_seen_from_the_object(frame):
    nothing = np.zeros((48, 64), np.bool_)
    depth = np.full((48, 64), 2.0, np.float32)
    centre = np.array([0.1, 0.1, 1.8])
    directions, _ = background_pixels(frame, nothing, depth, centre)
    point = np.array([0.5, -0.2, 1.0]) + 2.0 * np.array([(7 - 31.5) / 50, (5 - 23.5) / 50, 1.0])
    np.testing.assert_allclose(directions[5 * 64 + 7], point - centre, rtol=1e-6)


def test_what_touches_the_object_is_left_out(frame):
    """A direction from the object's middle would mean nothing to its sides."""
    nothing = np.zeros((48, 64), np.bool_)
    depth = np.full((48, 64), 1.2, np.float32)
    depth[:, :10] = 0.0
    depth[:, 40:] = 2.0
    centre = np.array([0.5, -0.2, 2.0])
    far, _ = background_pixels(frame, nothing, depth, centre)
    kept, _ = background_pixels(frame, nothing, depth, centre, 0.85)
    assert len(kept) < len(far) == 48 * 64
    pixel_rays = far.reshape(48, 64, 3)[:, :10].reshape(-1, 3)
    points = far.reshape(48, 64, 3)[:, 10:].reshape(-1, 3)
    outside = points[np.linalg.norm(points, axis=1) > 0.85]
    assert len(kept) == len(pixel_rays) + len(outside)
    assert {tuple(one) for one in pixel_rays} <= {tuple(one) for one in kept}


def test_a_near_wall_is_seen_from_the_objects_place():
    """A spot on a wall 0.9 m from the object, seen past it by cameras 0.5 m on the other side."""
    spot = np.array([-0.9, 0.3, 0.1])
    scan = Scan(SETTINGS, RegionSettings("sphere", (0.0, 0.0, 0.0), (0.3, 0.3, 0.3)))
    for number in range(-4, 5):
        frame = render([OBJECT], look_at(orbit(number, 40)), number + 4)
        camera, pose = frame.intrinsics, frame.T_world_camera
        v, u = np.mgrid[: camera.height, : camera.width]
        rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones_like(u)])
        rays = np.einsum("ij,jvu->vui", pose[:3, :3], rays)
        wall = (-0.9 - pose[0, 3]) / rays[..., 0]
        points = pose[:3, 3] + wall[..., None] * rays
        is_wall = frame.depth == 0.0
        frame.depth[is_wall] = wall[is_wall]
        frame.rgb[is_wall & (np.linalg.norm(points - spot, axis=-1) < 0.06)] = 220
        scan.fuse(frame)
    seen = scan.light.observed()
    bright = octahedral_directions(SIZE)[seen.radiance[..., 0] > 0.3]
    assert len(bright) >= 4
    angles = np.degrees(np.arccos(bright @ (spot / np.linalg.norm(spot))))
    # The spot is 7 degrees across; the centre of what a frame shows lies towards the camera.
    assert angles.max() < 9.0


def test_the_object_and_its_rim_are_left_out(frame):
    foreground = np.zeros((48, 64), np.bool_)
    foreground[20:30, 20:40] = True
    directions, _ = background_pixels(frame, foreground, frame.depth, np.zeros(3))
    u = np.rint(directions[:, 0] * 50 + 31.5).astype(int)
    v = np.rint(directions[:, 1] * 50 + 23.5).astype(int)
    rim = slice(20 - MARGIN, 40 + MARGIN), slice(20 - MARGIN, 30 + MARGIN)
    inside = (u >= rim[0].start) & (u < rim[0].stop) & (v >= rim[1].start) & (v < rim[1].stop)
    assert not inside.any()
    assert len(directions) == 48 * 64 - (20 + 2 * MARGIN) * (10 + 2 * MARGIN)


def test_a_large_image_is_thinned(frame):
    big = dataclasses.replace(
        frame,
        rgb=np.zeros((480, 640, 3), np.uint8),
        depth=np.zeros((480, 640), np.float32),
        intrinsics=CameraIntrinsics(640, 480, 500, 500, 319.5, 239.5),
    )
    directions, _ = background_pixels(big, big.depth > 0, big.depth, np.zeros(3))
    assert len(directions) == ACROSS * 60


def test_old_light_gives_way_to_new():
    light = LightMap()
    up = np.tile(np.array([[0.0, 0.0, 1.0]], np.float32), (int(4 * LONGEST_MEMORY), 1))
    light.add(up, np.zeros((len(up), 3), np.uint8))
    light.add(up, np.full((len(up), 3), 254, np.uint8))
    seen = light.observed()
    assert seen.radiance.max() > 0.85
    assert light.count.max() <= LONGEST_MEMORY


SETTINGS = FusionSettings(voxel_size=0.01, memory_budget_mb=64)


def scan_of(frames):
    scan = Scan(SETTINGS, RegionSettings())
    for one in frames:
        scan.fuse(one)
    return scan


def test_a_scan_gathers_saves_and_forgets_its_light(tmp_path):
    scan = scan_of(orbit_frames(4))
    seen = scan.snapshot().light
    assert 0.0 < seen.seen_share < 0.9
    scan.save(tmp_path / "scan")
    again = Scan.load(tmp_path / "scan").snapshot().light
    for name, array in vars(seen).items():
        np.testing.assert_array_equal(array, getattr(again, name))
    scan.reset()
    assert scan.snapshot().light.seen_share == 0.0


def test_a_refused_frame_leaves_the_light_alone():
    scan = scan_of(orbit_frames(2))
    before = scan.snapshot().light
    with pytest.raises(FrameRefused):
        scan.fuse(next(iter(orbit_frames(1))))
    np.testing.assert_array_equal(scan.snapshot().light.radiance, before.radiance)


def test_holes_in_the_surface_are_no_light():
    depth = np.full((40, 60), 0.5, np.float32)
    foreground = np.ones((40, 60), bool)
    depth[10:20, 10:20] = 0.0  # a shining spot on the surface
    depth[:, 40:] = 0.0  # the sky
    foreground[depth == 0.0] = False
    filled = without_holes(depth, foreground, 1)
    assert filled[10:20, 10:20].all()
    assert not filled[:, 40:].any()


def test_gaps_before_the_background_are_light():
    depth = np.full((40, 60), 0.5, np.float32)
    depth[:, 20:] = 4.0
    foreground = depth < 1.0
    depth[10:20, 30:40] = 0.0
    np.testing.assert_array_equal(without_holes(depth, foreground, 1), foreground)
