# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Dozens of malformed messages to one node: it lives on and fuses the next good frames."""

from __future__ import annotations

import array
import math
import random

from builtin_interfaces.msg import Time
from sphere_messages import (
    CAMERA_INFO,
    DEPTH,
    POSE,
    RGB,
    camera_info_message,
    depth_message,
    pose_message,
    rgb_message,
)

from reflest_core.capture.settings import CaptureSettings

UINT32 = (0, 1, 119, 121, 2**16, 2**31, 2**32 - 1)
FLOATS = (math.nan, math.inf, -math.inf, 0.0, -1.0, 1e300, 1e-320)
TEXTS = ("", "/", "rgb8", "16UC1", "x" * 5000, "é\n\t", "camera_depth_optical_frame")
TIMES = ((0, 0), (-1, 0), (2**31 - 1, 999_999_999), (-(2**31), 0), (100, 2**32 - 1))
DATA = (0, 1, 3 * 160 * 120 - 1, 3 * 160 * 120 + 1, 10**6)


def damaged_image(message, pick):
    field = pick(("stamp", "frame_id", "height", "width", "encoding", "step", "data", "endian"))
    if field == "data":
        message.data = array.array("B", bytes(pick(DATA)))
    elif field == "encoding":
        message.encoding = pick(TEXTS)
    elif field == "endian":
        message.is_bigendian = 255
    elif field in ("height", "width", "step"):
        setattr(message, field, pick(UINT32))
    return _damaged_header(message, field, pick)


def damaged_info(message, pick):
    field = pick(("stamp", "frame_id", "height", "width", "k", "d", "model", "binning", "roi"))
    if field == "k":
        message.k = [pick(FLOATS) for _ in range(9)]
    elif field == "d":
        message.d = [pick(FLOATS) for _ in range(pick((0, 1, 5, 8, 1000)))]
    elif field == "model":
        message.distortion_model = pick(TEXTS)
    elif field == "binning":
        message.binning_x, message.binning_y = pick(UINT32), pick(UINT32)
    elif field == "roi":
        message.roi.x_offset, message.roi.width = pick(UINT32), pick(UINT32)
    elif field in ("height", "width"):
        setattr(message, field, pick(UINT32))
    return _damaged_header(message, field, pick)


def damaged_pose(message, pick):
    field = pick(("stamp", "frame_id", "position", "orientation"))
    if field in ("position", "orientation"):
        setattr(getattr(message.pose, field), pick("xyz"), pick(FLOATS))
    return _damaged_header(message, field, pick)


def _damaged_header(message, field, pick):
    if field == "stamp":
        sec, nanosec = pick(TIMES)
        message.header.stamp = Time(sec=sec, nanosec=nanosec)
    elif field == "frame_id":
        message.header.frame_id = pick(TEXTS)
    return message


class Sender:
    """Sends views a few at a time, so that none is lost between the processes."""

    def __init__(self, feed):
        self.feed = feed
        self.sent = feed.peer.count("messages rgb")

    def send(self, **instead):
        view = self.feed.next_view()
        self.feed.send(view, **{name: make(view) for name, make in instead.items()})
        self.sent += 1
        if self.sent % 5 == 0:
            self.wait()

    def wait(self):
        """Wait until the node has taken every image and nothing waits for fusion."""
        peer = self.feed.peer
        peer.wait_until(
            lambda: peer.count("messages rgb") == self.sent and peer.diagnostics["queue"] == "0",
            f"not {self.sent} images taken",
        )


def test_the_node_outlives_them_and_fuses_what_comes_next(feed):
    feed.send_good()
    pick = random.Random(7).choice
    makers = {
        "info": (camera_info_message, damaged_info),
        "pose": (pose_message, damaged_pose),
        "depth": (depth_message, damaged_image),
        "rgb": (rgb_message, damaged_image),
    }
    sender = Sender(feed)
    for _ in range(60):
        name = pick(list(makers))
        make, damage = makers[name]
        sender.send(**{name: lambda view, make=make, damage=damage: damage(make(view), pick)})
    sender.wait()
    # A frame whose depth claims another camera waits for its transform, and others behind it, until
    # the queue is full: after as many good frames, all that waits or ran ahead is behind.
    fused = feed.peer.count("frames fused")
    for _ in range(CaptureSettings().queue_size + 5):
        sender.send()
    sender.wait()
    assert feed.peer.count("frames fused") >= fused + 10
    feed.send_good()
    refused = [key for key in feed.peer.diagnostics if key.startswith("refused")]
    assert len(refused) >= 6, refused
    for key in refused:
        cause = key.removeprefix("refused ")
        assert len(feed.node.lines_with(rf"\(cause: {cause}; logged once\)")) == 1
    assert {RGB, DEPTH, POSE, CAMERA_INFO} <= {
        topic
        for topic in (RGB, DEPTH, POSE, CAMERA_INFO)
        if feed.node.lines_with(f"{topic}.*logged once")
    }
