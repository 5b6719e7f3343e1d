# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Bags whose poses are in /tf, whose depth is not registered, or that start again."""

from dataclasses import replace

import numpy as np
import pytest

from reflest_core.capture.messages import PoseMessage, Role, TransformsMessage
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import CaptureError
from reflest_core.capture.settings import CaptureSettings
from test.core.capture.recording import TOPICS, Recorded, recording, write_bag
from test.core.capture.test_assembler import assemble, counts

CAMERA, DEPTH = "camera_color_optical_frame", "camera_depth_optical_frame"
NAMES = {
    **TOPICS,
    Role.DEPTH: "/camera/depth/image_rect_raw",
    Role.DEPTH_INFO: "/camera/depth/camera_info",
    Role.TF: "/tf",
    Role.TF_STATIC: "/tf_static",
}
BY_TF = CaptureSettings(pose_source="tf", world_frame="map")


def in_tf(messages):
    """Poses as transforms of the base, on which the camera is mounted."""
    mount = PoseMessage(
        messages[0].message.stamp_ns, "base", (0.0,) * 3, (0.0, 0.0, 0.0, 1.0), CAMERA
    )
    moving = [
        Recorded(
            Role.TF,
            TransformsMessage((replace(one.message, frame_id="map", child_frame_id="base"),)),
        )
        if one.role is Role.POSE
        else one
        for one in messages
    ]
    return [Recorded(Role.TF_STATIC, TransformsMessage((mount,))), *moving]


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_poses_are_taken_from_tf(tmp_path, storage):
    write_bag(tmp_path / "bag", in_tf(recording(5)), storage, NAMES)
    capture = open_capture(tmp_path / "bag", settings=BY_TF)
    expected, _ = assemble(recording(5))
    for frame, other in zip(capture, expected, strict=True):
        assert np.allclose(frame.T_world_camera, other.T_world_camera)
    assert counts(capture.refusals) == {}


def test_a_bag_with_tf_alone_asks_for_the_world_frame(tmp_path):
    write_bag(tmp_path / "bag", in_tf(recording(2)), topics=NAMES)
    with pytest.raises(CaptureError, match="--world-frame"):
        open_capture(tmp_path / "bag")


def test_a_folder_has_no_tf(tmp_path):
    (tmp_path / "rgb.txt").write_text("")
    with pytest.raises(CaptureError, match="has no tf"):
        open_capture(tmp_path, settings=BY_TF)


def test_unregistered_depth_is_registered_with_what_the_bag_holds(tmp_path):
    messages = []
    for one in recording(4):
        if one.role is Role.DEPTH:
            one = Recorded(one.role, replace(one.message, frame_id=DEPTH))
        messages.append(one)
        if one.role is Role.CAMERA_INFO:
            messages.append(Recorded(Role.DEPTH_INFO, replace(one.message, frame_id=DEPTH)))
    aside = PoseMessage(messages[0].message.stamp_ns, CAMERA, (0.02, 0, 0), (0, 0, 0, 1), DEPTH)
    static = Recorded(Role.TF_STATIC, TransformsMessage((aside,)))
    write_bag(tmp_path / "bag", [static, *messages], topics=NAMES)
    capture = open_capture(tmp_path / "bag")
    frames = list(capture)
    assert counts(capture.refusals) == {}
    assert len(frames) == 4
    assert (frames[0].depth[0, :2] == 0).all(), "the depth camera stands to the right"


def test_a_bag_that_starts_again_is_read_through(tmp_path):
    """Two recordings one after the other, the second with the first one's stamps."""
    later = [
        Recorded(one.role, replace(one.message, stamp_ns=one.message.stamp_ns + 100 * 10**9))
        for one in recording(4)
    ]
    write_bag(tmp_path / "a", later)
    write_bag(tmp_path / "b", recording(4))
    joined = tmp_path / "joined"
    joined.mkdir()
    for number, part in enumerate(("a", "b")):
        (file,) = (tmp_path / part).glob("*.mcap")
        file.rename(joined / f"joined_{number}.mcap")
    jumps = []
    capture = open_capture(joined, on_clock_jump=jumps.append)
    assert len(list(capture)) == 7, "a jump costs the frame that tells it"
    assert len(jumps) == 1
    assert counts(capture.refusals)["clock_jump"] == 1
