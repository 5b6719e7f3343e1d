# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The demo's close-up: cut around what has depth, whole where that fills the image."""

from __future__ import annotations

import numpy as np

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.frame import Frame
from reflest_ros.demo.shipped_capture import CLOSE_UP, cut_to_object


def frame_with_object(rows: slice, columns: slice) -> Frame:
    depth = np.zeros((120, 160), np.float32)
    depth[rows, columns] = 1.0
    rgb = np.repeat((depth > 0)[..., None].astype(np.uint8) * 255, 3, axis=2)
    return Frame(1, rgb, depth, np.eye(4), CameraIntrinsics(160, 120, 100.0, 100.0, 79.5, 59.5))


def test_it_holds_the_whole_object_in_the_images_proportions():
    picture = cut_to_object(frame_with_object(slice(50, 80), slice(100, 140)))
    assert (picture > 0).all(axis=2).sum() == 30 * 40
    height, width = picture.shape[:2]
    assert abs(width - CLOSE_UP * 40) < 3
    assert abs(width / height - 160 / 120) < 0.05


def test_an_object_at_the_border_keeps_the_cut_inside():
    picture = cut_to_object(frame_with_object(slice(100, 120), slice(0, 30)))
    assert (picture > 0).all(axis=2).sum() == 20 * 30


def test_depth_everywhere_means_the_whole_image():
    frame = frame_with_object(slice(0, 120), slice(0, 160))
    assert cut_to_object(frame) is frame.rgb
