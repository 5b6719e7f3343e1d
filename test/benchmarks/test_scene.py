# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The scene that is measured on must be what it says: exact geometry, steady, hand-held."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.scene.floor import floor_region, overview_frames
from benchmarks.scene.hand_held_orbit import pose_at
from benchmarks.scene.recording import Recording, recorded, rendered_frames
from benchmarks.scene.renderer import camera_of, render
from benchmarks.scene.table_scene import ELLIPSOIDS, REGION
from reflest_core.capture.open_capture import open_capture
from reflest_core.fusion.frames.region import Region

CAMERA = camera_of(160, 120)
SMALL = Recording(160, 120, 3, 10.0)


def world_points(depth_mm, pose):
    v, u = np.nonzero(depth_mm)
    z = depth_mm[v, u] / 1000.0
    rays = np.stack([(u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy, np.ones(len(u))], 1)
    return (rays * z[:, None]) @ pose[:3, :3].T + pose[:3, 3]


@pytest.mark.parametrize("seconds", [0.0, 7.0, 13.0])
def test_depth_in_the_region_lies_on_the_objects_surface(seconds):
    pose = pose_at(seconds)
    points = world_points(render(CAMERA, pose, 5)[1], pose)
    inside = points[Region.from_settings(REGION).contains(points)]
    parts = ELLIPSOIDS[:3]
    # An ellipsoid's level function is 1 on its surface; noise is a percent of its size.
    level = np.linalg.norm((inside[:, None] - parts[:, :3]) / parts[:, 3:6], axis=2).min(axis=1)
    assert len(inside) > 500
    # A few noisy points of the table reach into the region.
    assert np.mean(np.abs(level - 1.0) < 0.1) > 0.97


def test_the_same_frame_is_rendered_alike_and_its_noise_differs_from_frame_to_frame():
    first, again = render(CAMERA, pose_at(1.0), 3), render(CAMERA, pose_at(1.0), 3)
    other = render(CAMERA, pose_at(1.0), 4)
    assert np.array_equal(first[0], again[0])
    assert np.array_equal(first[1], again[1])
    assert np.array_equal(first[0], other[0]), "colour has no noise"
    assert np.mean(first[1] != other[1]) > 0.5


def test_gloss_moves_with_the_view():
    object_red = [render(CAMERA, pose_at(t), 0)[0].max() for t in (0.0, 6.0)]
    assert min(object_red) == 255


def test_the_camera_looks_at_the_object_from_half_a_metre():
    for seconds in np.linspace(0.0, 60.0, 100):
        pose = pose_at(seconds)
        to_object = np.array([0.0, 0.0, 0.13]) - pose[:3, 3]
        assert 0.4 < np.linalg.norm(to_object) < 0.8
        assert pose[:3, 2] @ to_object / np.linalg.norm(to_object) > 0.98
        assert pose[2, 3] > 0.1


def test_a_recording_is_rendered_once_and_holds_the_frames(tmp_path):
    bag = recorded(SMALL, tmp_path)
    written = {path: path.stat().st_mtime_ns for path in bag.iterdir()}
    frames = list(open_capture(bag))
    assert len(frames) == SMALL.frames
    for frame, expected in zip(frames, rendered_frames(SMALL), strict=True):
        assert frame.stamp_ns == expected.stamp_ns
        assert np.array_equal(frame.rgb, expected.rgb)
        assert np.array_equal(frame.depth, expected.depth)
        assert np.allclose(frame.T_world_camera, expected.T_world_camera)
    assert recorded(SMALL, tmp_path) == bag
    assert {path: path.stat().st_mtime_ns for path in bag.iterdir()} == written
    assert [path.name for path in tmp_path.iterdir()] == [bag.name]


def test_the_floor_is_seen_from_everywhere_it_reaches():
    region = Region.from_settings(floor_region(1.0))
    frames = list(overview_frames(1.0))
    centres = np.array([frame.camera_centre for frame in frames])
    assert centres[:, :2].min() <= -0.5
    assert centres[:, :2].max() >= 0.5
    v, u = np.mgrid[:480:16, :640:16]
    K, T = frames[0].intrinsics, frames[0].T_world_camera
    rays = np.stack([(u - K.cx) / K.fx, (v - K.cy) / K.fy, np.ones(u.shape)], -1).reshape(-1, 3)
    points = (rays * float(frames[0].depth[0, 0])) @ T[:3, :3].T + T[:3, 3]
    assert np.allclose(points[:, 2], 0.0)
    assert region.contains(points).any()
