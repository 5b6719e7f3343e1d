# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The surface point in the middle of a view."""

import dataclasses

import numpy as np

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames.work_sphere import view_middle

CAMERA = CameraIntrinsics(width=81, height=61, fx=50.0, fy=50.0, cx=30.0, cy=20.0)
POSE = np.eye(4)
POSE[:3, 3] = (1.0, 2.0, 3.0)


def frame(depth):
    return Frame(0, np.zeros((61, 81, 3), np.uint8), depth.astype(np.float32), POSE, CAMERA)


def test_it_lies_on_the_ray_through_the_centre_of_the_image():
    found = view_middle(frame(np.full((61, 81), 0.5)), 1.0)
    np.testing.assert_allclose(found, [1.0 + 0.5 * 10 / 50, 2.0 + 0.5 * 10 / 50, 3.5])


def test_a_few_wrong_depths_do_not_move_it():
    depth = np.full((61, 81), 0.5)
    depth[30, 40], depth[29, 40], depth[31, 40] = 0.9, 0.0, np.nan
    assert view_middle(frame(depth), 1.0)[2] == 3.5


def test_without_depth_there_the_nearest_pixel_counts():
    depth = np.zeros((61, 81))
    depth[30, 60], depth[5, 5] = 0.8, 0.4
    np.testing.assert_allclose(
        view_middle(frame(depth), 1.0), [1.0 + 0.8 * 30 / 50, 2.0 + 0.8 * 10 / 50, 3.8], rtol=1e-6
    )


def test_what_is_farther_than_the_scan_reaches_does_not_count():
    near = frame(np.full((61, 81), 0.5))
    assert view_middle(near, 0.4) is None
    assert view_middle(dataclasses.replace(near, depth=np.zeros_like(near.depth)), 1.0) is None
