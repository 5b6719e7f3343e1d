# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A calibration that no camera has is explained; crops, fisheyes and odd pixels are taken."""

import math

import pytest

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.camera_problem import camera_problem


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ((320.0, 240.0, 575.0, 575.0), "look like cx, cy, fx, fy"),
        ((320.0, 240.0, 400.0, 400.0), "look like cx, cy, fx, fy"),
        ((575.0, 320.0, 575.0, 240.0), "look like fx, cx, fy, cy"),
        ((1150.0, 1150.0, 640.0, 480.0), "2 times as large"),
        ((0.575, 0.575, 0.5, 0.5), "no camera has such a field of view"),
        ((575.0, 1e-3, 320.0, 240.0), "no camera has such a field of view"),
        ((9e5, 9e5, 320.0, 240.0), "no camera has such a field of view"),
        ((575.0, 575.0, 320.0, -1e9), "no camera has such a field of view"),
        ((575.0, -575.0, 320.0, 240.0), "positive focal lengths"),
        ((575.0, 575.0, math.nan, 240.0), "finite numbers"),
    ],
)
def test_an_impossible_calibration_is_explained(numbers, words):
    assert words in camera_problem(CameraIntrinsics(640, 480, *numbers))


@pytest.mark.parametrize(
    ("size", "numbers"),
    [
        ((640, 480), (575.0, 575.0, 320.0, 240.0)),
        ((640, 480), (130.0, 130.0, 320.0, 240.0)),  # 136 degrees across
        ((640, 480), (18000.0, 18000.0, 320.0, 240.0)),  # 2 degrees
        ((512, 512), (540.0, 960.0, 256.0, 256.0)),  # a wide image made square
        ((64, 48), (575.0, 575.0, -180.0, 220.0)),  # a corner of 640 x 480
        ((64, 48), (575.0, 575.0, 310.0, 20.0)),
        ((1, 1), (1.0, 1.0, 0.0, 0.0)),
        ((500, 1), (300.0, 300.0, 250.0, 0.0)),
    ],
)
def test_crops_and_wide_long_or_squeezed_images_are_possible(size, numbers):
    assert camera_problem(CameraIntrinsics(*size, *numbers)) == ""


def test_the_upper_left_quarter_of_an_image_is_possible_where_it_is_known_to_be_one():
    camera = CameraIntrinsics(320, 240, 525.0, 525.0, 320.0, 240.0)
    assert "for a crop of that image" in camera_problem(camera)
    assert camera_problem(camera, is_crop=True) == ""
