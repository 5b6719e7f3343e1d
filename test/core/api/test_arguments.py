# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the Python API refuses, and that the sentence says what to pass instead."""

import numpy as np
import pytest

from reflest_core.api.arguments import (
    ArgumentRefused,
    checked_colour,
    checked_depth,
    checked_intrinsics,
    checked_pose,
    checked_stamp,
)
from reflest_core.capture.camera import CameraIntrinsics

SHAPE = (48, 64)
K = np.array([[60.0, 0.0, 31.5], [0.0, 61.0, 23.5], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize(
    ("rgb", "sentence"),
    [
        (np.zeros((48, 64, 3), np.float32), "multiply values in"),
        (np.zeros((48, 64, 3), np.int64), "expected uint8"),
        (np.zeros((48, 64), np.uint8), r"expected \(height, width, 3\)"),
        (np.zeros((3, 48, 64), np.uint8), r"expected \(height, width, 3\)"),
        (np.zeros((48, 64, 4), np.uint8), r"expected \(height, width, 3\)"),
        (np.zeros((0, 64, 3), np.uint8), r"expected \(height, width, 3\)"),
    ],
)
def test_colour_that_is_not_eight_bit_rgb_is_refused(rgb, sentence):
    with pytest.raises(ArgumentRefused, match=sentence):
        checked_colour(rgb)


@pytest.mark.parametrize(
    ("depth", "scale", "sentence"),
    [
        (np.ones((64, 48), np.float32), None, "width and height look swapped"),
        (np.ones((24, 32), np.float32), None, "register depth to colour"),
        (np.full(SHAPE, 812, np.uint16), None, "depth_scale"),
        (np.full(SHAPE, 812.0, np.float32), None, "looks like millimetres"),
        (np.full(SHAPE, 812, np.uint16), 1.0, "looks like millimetres"),
        (np.full(SHAPE, True), None, "expected floats"),
    ],
)
def test_depth_of_another_size_or_unit_is_refused(depth, scale, sentence):
    with pytest.raises(ArgumentRefused, match=sentence):
        checked_depth(depth, SHAPE, scale)


def test_unknown_depth_becomes_zero_and_units_metres():
    depth = np.full(SHAPE, 800, np.uint16)
    depth[0] = 0
    metres = checked_depth(depth, SHAPE, 0.001)
    assert metres.dtype == np.float32
    np.testing.assert_allclose(metres[1:], 0.8, rtol=1e-6)
    assert not metres[0].any()
    holes = np.full(SHAPE, 0.5)
    holes[:, :3] = np.nan, np.inf, -1.0
    metres = checked_depth(holes, SHAPE, None)
    assert not metres[:, :3].any()
    assert (metres[:, 3:] == 0.5).all()


@pytest.mark.filterwarnings("error")
def test_depth_beyond_float32_is_unknown_without_a_warning():
    assert not checked_depth(np.full(SHAPE, 1e300), SHAPE, None).any()


@pytest.mark.parametrize(
    ("matrix", "sentence"),
    [
        (K.T, "as rows"),
        (np.eye(4), r"expected \(3, 3\)"),
        ((31.5, 23.5, 60.0, 61.0), "the order is fx, fy, cx, cy"),
        ((60.0, -61.0, 31.5, 23.5), "positive focal lengths"),
        ((1e308, 61.0, 31.5, 23.5), "no camera has such a field of view"),
        ((1e-3, 1e-3, 31.5, 23.5), "no camera has such a field of view"),
        ((9e5, 9e5, 31.5, 23.5), "no camera has such a field of view"),
        ((60.0, 61.0, 1e9, 23.5), "no camera has such a field of view"),
        ((np.nan, 61.0, 31.5, 23.5), "positive focal lengths"),
        ((240.0, 240.0, 160.0, 120.0), "an image 5 times as large"),
        (CameraIntrinsics(64, 48, 0.0, 61.0, 31.5, 23.5), "positive focal lengths"),
        (CameraIntrinsics(320, 240, 240.0, 240.0, 160.0, 120.0), "belongs to images of 320 x 240"),
        ("K", "K is 'K': expected an array of numbers"),
        ([[60.0], [1.0, 2.0]], "expected an array of numbers"),
    ],
)
def test_a_calibration_that_cannot_be_is_refused(matrix, sentence):
    with pytest.raises(ArgumentRefused, match=sentence):
        checked_intrinsics(matrix, SHAPE)


def test_the_upper_left_quarter_of_an_image_is_taken_with_its_size():
    quarter = CameraIntrinsics(64, 48, 90.0, 90.0, 64.0, 48.0)
    assert checked_intrinsics(quarter, SHAPE) == quarter
    with pytest.raises(ArgumentRefused, match="pass CameraIntrinsics"):
        checked_intrinsics(quarter.matrix, SHAPE)


def test_the_principal_point_of_a_cropped_image_may_lie_outside_it():
    assert checked_intrinsics((600.0, 600.0, -90.0, 100.0), SHAPE).cx == -90.0


def test_all_forms_of_a_calibration_are_the_same():
    assert checked_intrinsics(K, SHAPE) == checked_intrinsics((60.0, 61.0, 31.5, 23.5), SHAPE)
    of_frame = CameraIntrinsics(64, 48, 60.0, 61.0, 31.5, 23.5)
    assert checked_intrinsics(of_frame, SHAPE) == checked_intrinsics(K, SHAPE)
    np.testing.assert_array_equal(checked_intrinsics(K, SHAPE).matrix, K)


def moved(**changes):
    pose = np.eye(4)
    for (row, column), value in changes.get("at", {}).items():
        pose[row, column] = value
    return pose


@pytest.mark.parametrize(
    ("pose", "sentence"),
    [
        (np.eye(3), r"expected \(4, 4\)"),
        (object(), "expected an array of numbers"),
        (moved(at={(0, 3): np.nan}), "NaN"),
        (moved(at={(0, 3): 1e308}), "10,000 km"),
        (moved(at={(3, 0): 0.4}), "transposed"),
        (moved(at={(0, 0): -1.0}), "mirrors"),
        (moved(at={(0, 0): 1.1}), "not orthonormal"),
    ],
)
def test_a_pose_that_is_no_rigid_motion_is_refused(pose, sentence):
    with pytest.raises(ArgumentRefused, match=sentence):
        checked_pose(pose)


def test_a_rounded_rotation_is_made_exact():
    rounded = moved(at={(0, 0): 1.0 + 5e-5, (0, 1): 3e-5})
    rotation = checked_pose(rounded)[:3, :3]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)


@pytest.mark.parametrize("stamp", ["a", [1.0], np.nan, 1e300, 9223372036.85477])
def test_a_stamp_that_is_no_time_is_refused(stamp):
    with pytest.raises(ArgumentRefused, match=r"stamp is .*expected"):
        checked_stamp(stamp)
