# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Messages to frames: what a frame holds, and each refusal by its cause with the rest unharmed."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.messages import CameraInfoMessage, ImageMessage, PoseMessage, Role
from reflest_core.capture.refusal import RefusalCause
from reflest_core.capture.settings import CaptureSettings
from test.core.capture.recording import (
    FOCAL,
    HEIGHT,
    TOPICS,
    WIDTH,
    camera_pose,
    changed,
    colour_of,
    depth_of,
    image,
    recording,
    stamp,
)


def assemble(messages, **values):
    assembler = FrameAssembler(CaptureSettings(**values), TOPICS)
    frames = [
        frame for recorded in messages for frame in assembler.add(recorded.role, recorded.message)
    ]
    return [*frames, *assembler.flush()], assembler.refusals


def counts(refusals):
    return {cause.value: count for cause, count in refusals.counts.items()}


def test_a_frame_holds_what_the_camera_saw():
    frames, refusals = assemble(recording(4))
    assert counts(refusals) == {}
    assert [frame.stamp_ns for frame in frames] == [stamp(index) for index in range(4)]
    for index, frame in enumerate(frames):
        assert np.array_equal(frame.rgb, colour_of(index))
        assert np.abs(frame.depth - depth_of(index)).max() < 0.001
        assert np.allclose(frame.T_world_camera, camera_pose(index))
        assert (frame.intrinsics.width, frame.intrinsics.fx) == (WIDTH, FOCAL)
        assert frame.frame_id == "camera_color_optical_frame"
        assert frame.mask is None


def metres_32fc1(index):
    millimetres = np.round(depth_of(index) * 1000)
    return image((millimetres * 0.001).astype("<f4"), "32FC1", stamp(index))


def test_32fc1_and_16uc1_give_the_very_same_frames():
    messages = recording(3)
    floats = [
        replace(recorded, message=metres_32fc1(index // 4))
        if recorded.role is Role.DEPTH
        else recorded
        for index, recorded in enumerate(messages)
    ]
    for one, other in zip(assemble(messages)[0], assemble(floats)[0], strict=True):
        assert np.array_equal(one.depth, other.depth)


NAN = math.nan
BAD = [
    (Role.RGB, {"encoding": "bayer_rggb16"}, "encoding", "bayer_rggb16"),
    (Role.RGB, {"data": b"\1"}, "truncated", "1 of"),
    (Role.RGB, {"width": WIDTH - 1}, "size", f"{WIDTH - 1} x {HEIGHT}"),
    (Role.DEPTH, {"encoding": "8UC1"}, "encoding", "8UC1"),
    (
        Role.DEPTH,
        {"height": HEIGHT - 2, "data": bytes(2 * WIDTH * (HEIGHT - 2))},
        "size",
        "aligned",
    ),
    (Role.DEPTH, {"frame_id": "camera_depth_optical_frame"}, "frame_mismatch", "check_frame_ids"),
    (Role.CAMERA_INFO, {"k": (0.0,) * 9}, "camera_info_invalid", "fx = 0"),
    (Role.CAMERA_INFO, {"width": 640, "height": 480}, "size", "640 x 480"),
    (Role.POSE, {"position": (NAN, 0.0, 0.0)}, "pose_invalid", "NaN"),
    (Role.POSE, {"orientation": (0.0,) * 4}, "pose_invalid", "norm"),
    (Role.POSE, {"child_frame_id": "base_link"}, "frame_mismatch", "pose_to_camera"),
]


@pytest.mark.parametrize(("role", "fields", "cause", "words"), BAD)
def test_one_bad_message_costs_one_frame_with_one_clear_sentence(role, fields, cause, words):
    messages = changed(recording(5), role, 2, **fields)
    frames, refusals = assemble(messages)
    assert counts(refusals) == {cause: 1}
    sentence = refusals.first_message[RefusalCause(cause)]
    assert words in sentence
    assert TOPICS[role] in sentence
    assert [frame.stamp_ns for frame in frames] == [stamp(index) for index in (0, 1, 3, 4)]


def test_every_refusal_reaches_the_listener_and_the_first_is_marked():
    heard = []
    assembler = FrameAssembler(
        CaptureSettings(), TOPICS, lambda refusal, first: heard.append((refusal.cause, first))
    )
    for recorded in recording(3):
        message = recorded.message
        if recorded.role is Role.RGB:
            message = replace(message, encoding="rgb16")
        assembler.add(recorded.role, message)
    assert heard == [(RefusalCause.ENCODING, True)] + [(RefusalCause.ENCODING, False)] * 2


def test_depth_in_another_frame_is_used_if_one_says_so():
    messages = changed(recording(2), Role.DEPTH, 0, frame_id="depth_frame")
    frames, _ = assemble(messages, check_frame_ids=False)
    assert len(frames) == 2


def test_odometry_of_the_base_is_taken_to_the_camera():
    # The camera looks along the base's x axis from 0.2 m above it (REP 103).
    forward = (0.0, 0.0, 0.2, -0.5, 0.5, -0.5, 0.5)
    pose = {"position": (1.0, 2.0, 0.0), "orientation": (0.0, 0.0, 0.0, 1.0)}
    messages = changed(recording(1), Role.POSE, 0, child_frame_id="base_link", **pose)
    (frame,), _ = assemble(messages, pose_to_camera=forward)
    assert np.allclose(frame.T_world_camera @ [0, 0, 1, 1], [2, 2, 0.2, 1])
    assert np.allclose(frame.T_world_camera @ [1, 0, 0, 1], [1, 1, 0.2, 1])


def test_distorted_images_come_out_rectified():
    coefficients = (-0.4, 0.2, 0.0, 0.0, 0.0)
    messages = changed(
        recording(1), Role.CAMERA_INFO, 0, d=coefficients, distortion_model="plumb_bob"
    )
    (frame,), refusals = assemble(messages)
    assert counts(refusals) == {}
    centre, corner = (HEIGHT // 2, WIDTH // 2), (0, 0)
    assert frame.depth[centre] == pytest.approx(depth_of(0)[centre], abs=1e-3)
    assert not np.array_equal(frame.rgb[corner], colour_of(0)[corner])


def test_the_mask_comes_with_the_frame():
    mask = (depth_of(0) < 0.55).astype(np.uint8) * 255
    assembler = FrameAssembler(CaptureSettings(use_mask=True))
    for recorded in recording(1):
        assert assembler.add(recorded.role, recorded.message) == []
    (frame,) = assembler.add(Role.MASK, image(mask, "mono8", stamp(0)))
    assert np.array_equal(frame.mask, mask > 0)
    assert 0 < frame.mask.mean() < 1


def test_a_reset_lets_time_start_again_and_keeps_the_counts():
    assembler = FrameAssembler(CaptureSettings(), TOPICS)
    for _ in range(2):
        frames = [
            frame
            for recorded in changed(recording(2), Role.RGB, 0, encoding="?")
            for frame in assembler.add(recorded.role, recorded.message)
        ]
        assert len(frames) == 1
        assembler.reset()
    assert counts(assembler.refusals) == {"encoding": 2}


numbers = st.one_of(st.integers(0, 2**32 - 1), st.just(WIDTH), st.just(HEIGHT))
any_image = st.builds(
    ImageMessage,
    stamp_ns=st.integers(0, 2**40),
    frame_id=st.sampled_from(["", "camera", "other"]),
    height=numbers,
    width=numbers,
    encoding=st.sampled_from(["rgb8", "16UC1", "32FC1", "mono8", "", "nonsense"]),
    is_bigendian=st.booleans(),
    step=numbers,
    data=st.binary(max_size=100),
)
any_pose = st.builds(
    PoseMessage,
    stamp_ns=st.integers(0, 2**40),
    frame_id=st.text(max_size=3),
    position=st.tuples(*[st.floats()] * 3),
    orientation=st.tuples(*[st.floats()] * 4),
    child_frame_id=st.sampled_from(["", "base"]),
)
any_info = st.builds(
    CameraInfoMessage,
    stamp_ns=st.integers(0, 2**40),
    frame_id=st.text(max_size=3),
    width=numbers,
    height=numbers,
    k=st.tuples(*[st.floats()] * 9),
)
any_message = st.one_of(
    st.tuples(st.sampled_from([Role.RGB, Role.DEPTH]), any_image),
    st.tuples(st.just(Role.POSE), any_pose),
    st.tuples(st.just(Role.CAMERA_INFO), any_info),
)


@settings(max_examples=300)
@given(st.lists(any_message, max_size=40))
def test_no_stream_of_garbage_gets_through_or_crashes(messages):
    assembler = FrameAssembler(CaptureSettings(queue_size=3, pose_queue_size=3, slop=1.0))
    frames = [frame for role, message in messages for frame in assembler.add(role, message)]
    for frame in [*frames, *assembler.flush()]:
        assert np.isfinite(frame.T_world_camera).all()
        assert np.isfinite(frame.depth).all()
        assert frame.depth.any()
        assert frame.rgb.shape[:2] == frame.depth.shape
    assert set(assembler.refusals.first_message) == set(assembler.refusals.counts)
