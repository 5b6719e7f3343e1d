# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Compressed colour and depth, and odometry, as a robot sends them over a thin line."""

from __future__ import annotations

import array
import struct

import cv2
import numpy as np
import pytest
from feed import Feed
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CompressedImage
from sphere_messages import (
    CAMERA_INFO,
    DEPTH,
    OPTICAL_FRAME,
    RGB,
    camera_info_message,
    header,
    pose_message,
)

RGB_PACKED, DEPTH_PACKED, ODOM = f"{RGB}/compressed", f"{DEPTH}/compressedDepth", "/odom"


@pytest.fixture(scope="module")
def node(start, settings_file):
    process = start(
        "reflest_ros.estimator",
        "--ros-args",
        "--params-file",
        settings_file,
        "-p",
        "input.rgb_transport:=compressed",
        "-p",
        "input.depth_transport:=compressedDepth",
        "-p",
        "capture.pose_source:=odom",
    )
    process.wait_for_line("listening to", 600.0)
    return process


def packed(view, form, data):
    return CompressedImage(header=header(view.stamp_ns), format=form, data=array.array("B", data))


def colour(view, suffix=".jpg"):
    return packed(
        view, "rgb8; jpeg compressed bgr8", cv2.imencode(suffix, view.rgb[:, :, ::-1])[1].tobytes()
    )


def depth(view):
    png = cv2.imencode(".png", np.round(view.depth * 1000).astype(np.uint16))[1].tobytes()
    return packed(view, "16UC1; compressedDepth png", struct.pack("<iff", 0, 0.0, 0.0) + png)


def odometry(view):
    message = Odometry(header=header(view.stamp_ns, "odom"), child_frame_id=OPTICAL_FRAME)
    message.pose.pose = pose_message(view).pose
    return message


def send(peer, view, **instead):
    peer.publish(CAMERA_INFO, camera_info_message(view))
    peer.publish(ODOM, odometry(view))
    peer.publish(DEPTH_PACKED, depth(view))
    peer.publish(RGB_PACKED, instead.get("rgb") or colour(view))


def test_they_are_fused(feed: Feed):
    for count in range(1, 9):
        send(feed.peer, feed.next_view())
        feed.peer.wait_for_count("frames fused", count)
    assert not [key for key in feed.peer.diagnostics if key.startswith("refused")]


def test_one_that_was_cut_off_is_refused_by_name(feed: Feed):
    view = feed.next_view()
    image = colour(view)
    image.data = image.data[: len(image.data) // 2]
    send(feed.peer, view, rgb=image)
    feed.expect_refusal("truncated", RGB_PACKED, "cut off or damaged")
    fused = feed.peer.count("frames fused")
    send(feed.peer, feed.next_view())
    feed.peer.wait_for_count("frames fused", fused + 1)


def test_a_format_that_is_not_read_is_refused_by_name(feed: Feed):
    view = feed.next_view()
    send(feed.peer, view, rgb=packed(view, "webp", b"RIFF....WEBPVP8 "))
    feed.expect_refusal("encoding", RGB_PACKED, "webp", "jpeg")
