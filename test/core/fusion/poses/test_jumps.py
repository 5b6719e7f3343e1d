# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Jumps of any size are found where they happen; fast, thinned and slow captures are none."""

from dataclasses import replace

import numpy as np
import pytest

from reflest_core.capture.open_capture import open_capture
from reflest_core.fusion.poses.agreement import DepthSample
from reflest_core.fusion.poses.jumps import JumpDetector

AT = 8
"""The first frame after the jump."""


@pytest.fixture(scope="module", params=["captures/glossy-red", "captures/table"])
def frames(request):
    return list(open_capture(request.param))[:14]


def shifted(metres):
    pose = np.eye(4)
    pose[0, 3] = metres
    return pose


def turned(degrees):
    pose = np.eye(4)
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    pose[:2, :2] = [[cosine, -sine], [sine, cosine]]
    return pose


def jumped(frames, jump, first=AT, last=None):
    return [
        replace(frame, T_world_camera=jump @ frame.T_world_camera)
        if first <= index and (last is None or index <= last)
        else frame
        for index, frame in enumerate(frames)
    ]


def at_rate(frames, hertz):
    """The same frames with other stamps."""
    return [replace(frame, stamp_ns=int(index * 1e9 / hertz)) for index, frame in enumerate(frames)]


def confirmed(frames):
    """Indices of the frames that confirm a jump."""
    detector = JumpDetector()
    return [
        index
        for index, frame in enumerate(frames)
        if detector.add(frame, DepthSample(frame)) is not None
    ]


@pytest.mark.parametrize(
    "jump",
    [shifted(0.4), shifted(1.0), shifted(5.0), shifted(5e6), turned(90.0), turned(180.0)],
    ids=["40 cm", "1 m", "5 m", "5000 km", "90 degrees", "180 degrees"],
)
def test_a_large_jump_is_confirmed_by_the_frame_after_it(frames, jump):
    assert confirmed(jumped(frames, jump)) == [AT + 1]


@pytest.mark.parametrize("first", [1, 2, 3])
def test_a_tracker_that_localises_after_a_few_frames_jumps(frames, first):
    assert confirmed(jumped(frames, shifted(4.6e6), first)) == [first + 1]


def test_one_frame_far_off_is_no_jump(frames):
    assert confirmed(jumped(frames, shifted(5.0), AT, AT)) == []


def test_a_pose_that_was_interpolated_across_the_jump_does_not_hide_it(frames):
    halfway = jumped(frames, shifted(2.5), AT, AT)
    assert confirmed(jumped(halfway, shifted(5.0), AT + 1)) == [AT + 2]


def test_a_slow_stream_jumps_where_alike_images_share_nothing(frames):
    slow = jumped(at_rate(frames, 1.0), shifted(2.0))
    assert confirmed(slow) == [AT + 1]
    unlike = [
        replace(frame, rgb=255 - frame.rgb) if index >= AT else frame
        for index, frame in enumerate(slow)
    ]
    assert confirmed(unlike) == []


@pytest.mark.parametrize("every", [1, 2, 4])
@pytest.mark.parametrize("hertz", [1.0, 30.0])
def test_neither_thinned_frames_nor_their_rate_is_a_jump(frames, every, hertz):
    assert confirmed(at_rate(frames[::every], hertz)) == []


def test_a_gap_in_the_stream_is_no_jump(frames):
    late = [replace(frame, stamp_ns=frame.stamp_ns + 10 * 10**9) for frame in frames[10:]]
    assert confirmed(frames[:6] + late) == []


def test_positions_in_another_unit_are_no_jump_though_the_camera_stops(frames):
    poses = [frame.T_world_camera.copy() for frame in frames]
    for pose in poses:
        pose[:3, 3] *= 1000.0
    moving = [
        replace(frame, T_world_camera=pose) for frame, pose in zip(frames, poses, strict=True)
    ]
    assert confirmed(at_rate(moving + [moving[-1]] * 4, 10.0)) == []
