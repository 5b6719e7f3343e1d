# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Bad images and calibrations: one named warning, a diagnostic, and the next frames are fused."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from sphere_messages import CAMERA_INFO, DEPTH, RGB, camera_info_message, depth_message, rgb_message
from std_srvs.srv import Trigger

from reflest_ros.outputs.estimate_message import estimate_from_message
from reflest_ros.srv import Estimate


def test_a_missing_camera_info(feed):
    """First of all, for a calibration that came once stays."""
    for _ in range(31):
        feed.send(feed.next_view(), info=None)
    feed.expect_refusal("camera_info_missing", CAMERA_INFO, "publish it or set its topic")
    feed.send_good()


def test_an_unknown_encoding(feed):
    for _ in range(2):
        view = feed.next_view()
        feed.send(view, rgb=rgb_message(view, "yuv422_plaid"))
    feed.expect_refusal("encoding", "yuv422_plaid", RGB, "rgb8")
    feed.peer.wait_for_count("refused encoding", 2)
    feed.send_good()


def test_depth_without_a_valid_pixel(feed):
    view = feed.next_view()
    feed.send(view, depth=depth_message(dataclasses.replace(view, depth=0 * view.depth)))
    feed.expect_refusal("depth_empty", DEPTH)
    feed.send_good()


def test_a_look_at_the_sky_is_taken_for_its_light(feed):
    feed.send_good()
    view = feed.next_view()
    backwards = view.T_world_camera @ np.diag([-1.0, 1.0, -1.0, 1.0])
    sky = dataclasses.replace(view, depth=0 * view.depth, T_world_camera=backwards)
    refused, seen = feed.peer.count("refused depth_empty"), feed.peer.count("frames of light alone")
    feed.send(sky)
    feed.peer.wait_for_count("frames of light alone", seen + 1)
    assert feed.peer.count("refused depth_empty") == refused


def test_an_image_that_was_cut_off(feed):
    view = feed.next_view()
    image = rgb_message(view)
    image.data = image.data[: len(image.data) // 2]
    feed.send(view, rgb=image)
    feed.expect_refusal("truncated", RGB)
    feed.send_good()


def test_a_size_that_is_not_the_calibrations(feed):
    view = feed.next_view()
    info = camera_info_message(view)
    info.width, info.height = 2 * info.width, 2 * info.height
    feed.send(view, info=info)
    feed.expect_refusal("size", CAMERA_INFO, RGB, "160 x 120", "320 x 240")
    feed.send_good()


def test_a_distortion_that_is_not_applied(feed):
    view = feed.next_view()
    info = camera_info_message(view)
    info.distortion_model, info.d = "omni", [0.1, 0.0, 0.0, 0.0]
    feed.send(view, info=info)
    feed.expect_refusal("camera_info_invalid", CAMERA_INFO, "omni", "plumb_bob")
    feed.send_good()


def test_float_metres_and_integer_millimetres_agree(feed):
    """The same depth as 16UC1 and as 32FC1, scanned twice from empty, gives the same estimate."""
    known = [feed.next_view() for _ in range(6)]
    estimates = []
    for encoding in ("16UC1", "32FC1"):
        assert feed.peer.call(Trigger, "reset").success
        for view in known:
            millimetres = np.round(view.depth * 1000).astype(np.uint16)
            exact = (millimetres.astype(np.float64) * 0.001).astype(np.float32)
            same = dataclasses.replace(view, depth=exact)
            before = feed.peer.count("frames fused")
            feed.send(same, depth=depth_message(same, encoding))
            feed.peer.wait_for_count("frames fused", before + 1)
        response = feed.peer.call(Estimate, "estimate")
        assert response.success, response.message
        estimates.append(estimate_from_message(response.estimate))
    first, second = (dataclasses.replace(one, latency=math.nan).to_json() for one in estimates)
    assert first == second
