# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Poses from tf: waited for, looked up at the image's stamp, given up, never made up."""

import random
from dataclasses import replace

import numpy as np
import pytest

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.messages import PoseMessage, Role, TransformsMessage
from reflest_core.capture.settings import CaptureSettings
from reflest_core.parameter import ParameterError
from test.core.capture.recording import (
    PERIOD_NS,
    TOPICS,
    Recorded,
    camera_pose,
    pose_message,
    recording,
    stamp,
)

CAMERA = "camera_color_optical_frame"
TF = {"pose_source": "tf", "world_frame": "map"}


def moving(message, frame="map", child="base"):
    """A pose message as a transform of the base."""
    one = replace(message, frame_id=frame, child_frame_id=child)
    return Recorded(Role.TF, TransformsMessage((one,)))


def mount(position=(0.0, 0.0, 0.0)):
    one = PoseMessage(0, "base", position, (0.0, 0.0, 0.0, 1.0), CAMERA)
    return Recorded(Role.TF_STATIC, TransformsMessage((one,)))


def with_tf(count=4, offset_ns=0):
    """The recording with its poses as transforms of the base, shifted in time."""
    return [
        moving(replace(one.message, stamp_ns=one.message.stamp_ns + offset_ns))
        if one.role is Role.POSE
        else one
        for one in recording(count)
    ]


def assemble(messages, **values):
    assembler = FrameAssembler(CaptureSettings(**{**TF, **values}), TOPICS)
    frames = [frame for one in messages for frame in assembler.add(one.role, one.message)]
    return [*frames, *assembler.flush()], assembler.refusals


def test_the_camera_stands_where_the_chain_of_frames_says():
    frames, refusals = assemble([mount((0.0, 0.0, 0.1)), *with_tf()])
    assert not refusals.counts
    for index, frame in enumerate(frames):
        forward = camera_pose(index)
        forward[:3, 3] += 0.1 * forward[:3, 2]
        assert np.allclose(frame.T_world_camera, forward)
        assert frame.world_frame_id == "map"
    assert len(frames) == 4


def test_a_transform_that_comes_late_is_waited_for():
    assembler = FrameAssembler(CaptureSettings(**TF), TOPICS)
    late = [one for one in with_tf(3) if one.role is Role.TF]
    for one in [mount(), *(one for one in with_tf(3) if one.role is not Role.TF)]:
        assert assembler.add(one.role, one.message) == []
    counts = [len(assembler.add(one.role, one.message)) for one in late]
    assert counts == [1, 1, 1]
    assert not assembler.refusals.counts


def test_between_two_transforms_the_pose_is_interpolated():
    frames, _ = assemble([mount(), *with_tf(3, offset_ns=-PERIOD_NS // 2)])
    middle = 0.5 * (camera_pose(0)[:3, 3] + camera_pose(1)[:3, 3])
    assert np.allclose(frames[0].T_world_camera[:3, 3], middle, atol=1e-6)


def test_any_order_of_arrival_gives_the_same_frames():
    expected, _ = assemble([mount(), *with_tf(6)])
    by_role = {}
    for one in [mount(), *with_tf(6)]:
        by_role.setdefault(one.role, []).append(one)
    shuffle = random.Random(3)
    for _ in range(20):
        queues = {role: list(messages) for role, messages in by_role.items()}
        mixed = []
        while any(queues.values()):
            role = shuffle.choice([role for role, queue in queues.items() if queue])
            mixed.append(queues[role].pop(0))
        frames, refusals = assemble(mixed)
        assert not refusals.counts
        for one, other in zip(frames, expected, strict=True):
            assert np.array_equal(one.T_world_camera, other.T_world_camera)


def given_up(messages, **values):
    frames, refusals = assemble(messages, **values)
    assert frames == []
    ((cause, count),) = refusals.counts.items()
    assert cause.value == "transform_missing"
    return count, refusals.first_message[cause]


def test_without_tf_every_frame_is_refused_and_none_stands_at_the_origin():
    count, sentence = given_up([one for one in with_tf(5) if one.role is not Role.TF])
    assert count == 5
    for word in ("map", CAMERA, "holds nothing yet"):
        assert word in sentence


def test_a_missing_link_is_named():
    _, sentence = given_up(with_tf(3))
    assert f"from '{CAMERA}' to 'map'" in sentence
    assert "base, map" in sentence


def test_a_queue_that_fills_up_in_waiting_for_tf_gives_the_oldest_up():
    messages = [one for one in with_tf(12) if one.role is not Role.TF]
    assembler = FrameAssembler(CaptureSettings(**TF, queue_size=5), TOPICS)
    for one in messages:
        assembler.add(one.role, one.message)
    ((cause, count),) = assembler.refusals.counts.items()
    assert (cause.value, count) == ("transform_missing", 7)


def test_after_max_wait_an_image_is_given_up():
    messages = [one for one in with_tf(12) if one.role is not Role.TF]
    assembler = FrameAssembler(CaptureSettings(**TF, max_wait=0.1), TOPICS)
    for one in messages:
        assembler.add(one.role, one.message)
    ((cause, count),) = assembler.refusals.counts.items()
    assert (cause.value, count) == ("transform_missing", 8), "images 8 to 11 span 0.1 s"


def test_images_without_a_frame_are_refused_at_once():
    messages = [
        Recorded(one.role, replace(one.message, frame_id="")) if one.role is Role.RGB else one
        for one in with_tf(2)
    ]
    _, sentence = given_up(messages)
    assert "names no frame_id" in sentence


def test_a_nan_transform_costs_its_frames_alone():
    messages = [mount(), *with_tf(4)]
    bad = replace(pose_message(1), position=(float("nan"), 0.0, 0.0))
    messages = [
        moving(bad) if one.role is Role.TF and one.message.stamp_ns == stamp(1) else one
        for one in messages
    ]
    frames, refusals = assemble(messages, max_transform_gap=0.05)
    assert [frame.stamp_ns for frame in frames] == [stamp(index) for index in (0, 2, 3)]
    counts = {cause.value: count for cause, count in refusals.counts.items()}
    assert counts == {"transform_invalid": 1, "transform_missing": 1}


def test_odometry_of_the_base_is_taken_to_the_camera_by_tf():
    messages = [
        Recorded(one.role, replace(one.message, child_frame_id="base"))
        if one.role is Role.POSE
        else one
        for one in recording(2)
    ]
    frames, _ = assemble([mount((0.0, 0.0, 0.1)), *messages], pose_source="odom")
    forward = camera_pose(0)
    assert np.allclose(frames[0].T_world_camera[:3, 3], forward[:3, 3] + 0.1 * forward[:3, 2])


def test_tf_needs_a_world_frame():
    with pytest.raises(ParameterError, match="world_frame"):
        CaptureSettings(pose_source="tf", world_frame="/")
