# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Bad poses, frames and stamps: one named warning, a diagnostic, and the next frames are fused."""

from __future__ import annotations

import dataclasses
import math

from sphere_messages import DEPTH, POSE, camera_info_message, depth_message, pose_message
from sphere_scene import PERIOD_NS

DEPTH_FRAME = "camera_depth_optical_frame"
DEPTH_INFO = "/camera/depth/camera_info"


def in_depth_frame(message):
    message.header.frame_id = DEPTH_FRAME
    return message


def test_a_nan_pose(feed):
    feed.send_good()
    view = feed.next_view()
    pose = pose_message(view)
    pose.pose.position.x = math.nan
    feed.send(view, pose=pose)
    feed.expect_refusal("pose_invalid", POSE, "NaN")
    feed.send_good()


def test_depth_in_another_frame_than_colour(feed):
    view = feed.next_view()
    feed.send(view, depth=in_depth_frame(depth_message(view)))
    feed.expect_refusal("frame_mismatch", DEPTH, DEPTH_FRAME, DEPTH_INFO)
    feed.send_good()


def test_depth_to_be_registered_without_a_transform(feed):
    view = feed.next_view()
    feed.peer.publish(DEPTH_INFO, in_depth_frame(camera_info_message(view)))
    feed.send(view, depth=in_depth_frame(depth_message(view)))
    feed.expect_refusal("transform_missing", DEPTH, DEPTH_FRAME, "capture.depth_to_rgb")
    feed.send_good()


def test_a_world_frame_that_changes(feed):
    before = feed.peer.count("refused frame_mismatch")
    view = feed.next_view()
    pose = pose_message(view)
    pose.header.frame_id = "odom"
    feed.send(view, pose=pose)
    feed.peer.wait_for_count("refused frame_mismatch", before + 1)
    feed.send_good()


def test_depth_that_is_not_synchronised(feed):
    """Depth comes half a period late, between the images."""
    for _ in range(4):
        view = feed.next_view(ahead=2)
        late = dataclasses.replace(view, stamp_ns=view.stamp_ns + PERIOD_NS)
        feed.send(view, depth=depth_message(late))
    feed.expect_refusal("depth_missing", DEPTH, "33.3 ms away", "capture.slop")
    feed.next_view()
    feed.send_good()


def test_a_message_that_is_late(feed):
    view = feed.next_view()
    early = dataclasses.replace(view, stamp_ns=view.stamp_ns - 5 * PERIOD_NS)
    feed.peer.publish(POSE, pose_message(early))
    feed.expect_refusal("time_backwards", POSE, "does not come after")
    feed.send_good()


def test_a_clock_that_jumps_back(feed):
    feed.next_view(ahead=-300)
    for _ in range(2):
        feed.send(feed.next_view())
    feed.expect_refusal("clock_jump", "the clock jumped back", "capture.clock_jump")
    feed.send_good()
