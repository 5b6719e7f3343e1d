# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Registered depth equals a brute-force search, and a plane stays where it is."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.images.depth_registration import REACH, register_depth

DEPTH_CAMERA = CameraIntrinsics(12, 9, 11.0, 11.5, 5.3, 4.1)
COLOUR_CAMERA = CameraIntrinsics(20, 16, 21.0, 20.0, 9.7, 8.2)


def rigid(rotation_vector=(0.0, 0.0, 0.0), position=(0.0, 0.0, 0.0)):
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec(rotation_vector).as_matrix()
    matrix[:3, 3] = position
    return matrix


def brute_force(depth, depth_camera, transform, colour_camera):
    """For every colour pixel, search all depth pixels for the nearest that covers its centre."""
    found = np.zeros((colour_camera.height, colour_camera.width))
    to_ray = np.linalg.inv(depth_camera.matrix)
    footprints = []
    for row, column in np.argwhere(depth > 0):
        corners = [
            transform
            @ np.append(float(depth[row, column]) * (to_ray @ [column + dx, row + dy, 1.0]), 1.0)
            for dx, dy in ((0, 0), (-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5))
        ]
        if min(corner[2] for corner in corners) <= 0:
            continue
        pixels = np.array([colour_camera.matrix @ corner[:3] / corner[2] for corner in corners])
        footprints.append((pixels.min(axis=0), pixels.max(axis=0), corners[0][2]))
    for y in range(colour_camera.height):
        for x in range(colour_camera.width):
            depths = [
                z for low, high, z in footprints if low[0] <= x < high[0] and low[1] <= y < high[1]
            ]
            found[y, x] = min(depths, default=0.0)
    return found


@settings(max_examples=25)
@given(
    st.tuples(*[st.floats(-0.3, 0.3)] * 3),
    st.tuples(*[st.floats(-0.2, 0.2)] * 3),
    st.integers(0, 2**32 - 1),
)
def test_it_equals_a_search_over_all_pixels(rotation, position, seed):
    random = np.random.default_rng(seed)
    depth = random.uniform(0.5, 2.0, (9, 12)).astype(np.float32)
    depth[random.random((9, 12)) < 0.3] = 0.0
    transform = rigid(rotation, position)
    found = register_depth(depth, DEPTH_CAMERA, transform, COLOUR_CAMERA)
    expected = brute_force(depth, DEPTH_CAMERA, transform, COLOUR_CAMERA)
    # A pixel centre on the very edge of a footprint may fall to either side in the last bit.
    assert np.isclose(found, expected, atol=1e-5).mean() > 0.999


def test_the_same_camera_in_the_same_place_changes_nothing():
    depth = np.random.default_rng(1).uniform(0.0, 3.0, (9, 12)).astype(np.float32)
    assert np.allclose(register_depth(depth, DEPTH_CAMERA, np.eye(4), DEPTH_CAMERA), depth)


def test_a_plane_seen_from_beside_has_no_holes_and_its_own_depth():
    """The colour camera is finer by twice, 5 cm to the right and turned by 3 degrees."""
    depth_camera = CameraIntrinsics(160, 120, 130.0, 130.0, 80.0, 60.0)
    colour_camera = CameraIntrinsics(320, 240, 280.0, 280.0, 160.0, 120.0)
    transform = rigid((0.0, math.radians(3.0), 0.0), (-0.05, 0.0, 0.0))
    depth = np.full((120, 160), 1.0, np.float32)  # the plane z = 1 m of the depth camera
    found = register_depth(depth, depth_camera, transform, colour_camera)
    rows, columns = np.mgrid[:240, :320]
    rays = np.stack([(columns - 160) / 280, (rows - 120) / 280, np.ones((240, 320))], axis=-1)
    normal, offset = transform[:3, 2], 1.0 + transform[:3, 2] @ transform[:3, 3]
    expected = offset / (rays @ normal)
    seen = found[40:200, 60:260]
    assert (seen > 0).all()
    assert np.abs(seen - expected[40:200, 60:260]).max() < 0.003


def test_the_nearer_surface_hides_the_further_one():
    depth_camera = CameraIntrinsics(40, 30, 40.0, 40.0, 20.0, 15.0)
    depth = np.full((30, 40), 2.0, np.float32)
    depth[10:20, 15:25] = 1.0
    found = register_depth(depth, depth_camera, rigid(position=(0.2, 0.0, 0.0)), depth_camera)
    # At 1 m the shift is 8 pixels, at 2 m it is 4.
    assert (found[11:19, 24:32] == 1.0).all()
    assert (found[:8][:, 5:] == 2.0).all()
    assert (found[11:19, 19:22] == 0.0).all(), "what the near surface hid stays unknown"


def test_what_lies_behind_the_colour_camera_is_not_seen():
    depth = np.full((9, 12), 1.0, np.float32)
    turned = rigid((0.0, math.pi, 0.0))
    assert not register_depth(depth, DEPTH_CAMERA, turned, COLOUR_CAMERA).any()


@settings(max_examples=100)
@given(
    st.lists(st.floats(1e-300, 1e300), min_size=4, max_size=4),
    st.lists(st.floats(-1e300, 1e300), min_size=4, max_size=4),
    st.tuples(*[st.floats(-1e6, 1e6)] * 3),
)
def test_absurd_calibrations_end_soon_and_harm_nothing(focal, centre, position):
    depth_camera = CameraIntrinsics(12, 9, focal[0], focal[1], centre[0], centre[1])
    colour_camera = CameraIntrinsics(200, 160, focal[2], focal[3], centre[2], centre[3])
    depth = np.linspace(0.1, 3.0, 108, dtype=np.float32).reshape(9, 12)
    found = register_depth(depth, depth_camera, rigid(position=position), colour_camera)
    assert found.shape == (160, 200)
    assert np.isfinite(found).all()
    assert np.count_nonzero(found) <= depth.size * (2 * REACH + 1) ** 2
