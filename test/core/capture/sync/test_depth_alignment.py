# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Depth in its own camera's frame: registered where all is known, else refused by name."""

from dataclasses import replace

import numpy as np
import pytest

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.messages import PoseMessage, Role, TransformsMessage
from reflest_core.capture.settings import CaptureSettings
from test.core.capture.recording import (
    HEIGHT,
    TOPICS,
    WIDTH,
    Recorded,
    depth_of,
    info_message,
    recording,
)

COLOUR, DEPTH = "camera_color_optical_frame", "camera_depth_optical_frame"
IDENTITY = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
ASIDE = (0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
TOPICS = {**TOPICS, Role.DEPTH_INFO: "/camera/depth/camera_info"}


def unregistered(count=4):
    """The recording with depth in the depth camera's frame."""
    return [
        Recorded(one.role, replace(one.message, frame_id=DEPTH)) if one.role is Role.DEPTH else one
        for one in recording(count)
    ]


def depth_info(**fields):
    return Recorded(Role.DEPTH_INFO, replace(info_message(0), frame_id=DEPTH, **fields))


def static(values=IDENTITY):
    position, rotation = values[:3], values[3:]
    one = PoseMessage(0, COLOUR, position, rotation, DEPTH)
    return Recorded(Role.TF_STATIC, TransformsMessage((one,)))


def assemble(messages, **values):
    assembler = FrameAssembler(CaptureSettings(**values), TOPICS)
    frames = [frame for one in messages for frame in assembler.add(one.role, one.message)]
    return [*frames, *assembler.flush()], assembler.refusals


def refused(messages, **values):
    """Return the one cause for which every frame was refused, and its first sentence."""
    frames, refusals = assemble(messages, **values)
    assert frames == []
    ((cause, count),) = refusals.counts.items()
    assert count == 4
    return cause.value, refusals.first_message[cause]


@pytest.mark.parametrize("by_parameter", [True, False])
def test_the_same_place_gives_the_same_depth(by_parameter):
    values = {"depth_to_rgb": IDENTITY} if by_parameter else {}
    messages = [depth_info(), *([] if by_parameter else [static()]), *unregistered()]
    frames, refusals = assemble(messages, **values)
    assert not refusals.counts
    for index, frame in enumerate(frames):
        assert np.abs(frame.depth - depth_of(index)).max() < 0.001
    assert len(frames) == 4


def test_parameter_and_tf_move_depth_alike_and_to_the_right():
    by_tf, _ = assemble([depth_info(), static(ASIDE), *unregistered(1)])
    by_parameter, _ = assemble([depth_info(), *unregistered(1)], depth_to_rgb=ASIDE)
    assert np.array_equal(by_tf[0].depth, by_parameter[0].depth)
    # The depth camera stands 2 cm to the right: 100 pixels x 0.02 m / 0.7 m = 2.9 to the right.
    edge = by_tf[0].depth[0]
    assert (edge[:2] == 0).all()
    assert (edge[3:] > 0).all()


def test_a_depth_camera_of_another_size_is_registered_to_colours():
    messages = []
    for one in unregistered(2):
        if one.role is Role.DEPTH:
            pixels = np.frombuffer(one.message.data, "<u2").reshape(HEIGHT, WIDTH)[::2, ::2]
            fields = {"height": HEIGHT // 2, "width": WIDTH // 2, "step": WIDTH}
            one = Recorded(one.role, replace(one.message, **fields, data=pixels.tobytes()))
        messages.append(one)
    half = (50.0, 0.0, WIDTH / 4, 0.0, 50.0, HEIGHT / 4, 0.0, 0.0, 1.0)
    info = depth_info(width=WIDTH // 2, height=HEIGHT // 2, k=half)
    frames, refusals = assemble([info, *messages], depth_to_rgb=IDENTITY)
    assert not refusals.counts
    assert frames[0].depth.shape == (HEIGHT, WIDTH)
    assert (frames[0].depth[:-2, :-2] > 0).all()
    inner = np.abs(frames[0].depth - depth_of(0))[2:-2, 2:-2]
    assert np.median(inner) < 0.005


def test_the_order_in_which_info_and_transform_come_changes_nothing():
    early, _ = assemble([depth_info(), static(ASIDE), *unregistered()])
    late, refusals = assemble([*unregistered(), static(ASIDE), depth_info()])
    assert not refusals.counts
    for one, other in zip(early, late, strict=True):
        assert np.array_equal(one.depth, other.depth)


def test_without_the_depth_cameras_info_it_is_refused_naming_what_lacks():
    cause, sentence = refused([static(), *unregistered()])
    assert cause == "frame_mismatch"
    for word in (DEPTH, COLOUR, TOPICS[Role.DEPTH_INFO], "capture.depth_to_rgb"):
        assert word in sentence


def test_without_the_transform_it_is_refused_naming_both_frames():
    cause, sentence = refused([depth_info(), *unregistered()])
    assert cause == "transform_missing"
    for word in (DEPTH, COLOUR, "holds nothing yet", "capture.depth_to_rgb"):
        assert word in sentence


def test_an_info_of_another_size_is_refused():
    cause, sentence = refused([depth_info(width=320, height=240), static(), *unregistered()])
    assert cause == "size"
    assert TOPICS[Role.DEPTH_INFO] in sentence


def test_a_depth_camera_with_distortion_is_rectified_first():
    bent = {"d": (-0.3, 0.1, 0.0, 0.0, 0.0), "distortion_model": "plumb_bob"}
    plain, _ = assemble([depth_info(), *unregistered(1)], depth_to_rgb=IDENTITY)
    frames, _ = assemble([depth_info(**bent), *unregistered(1)], depth_to_rgb=IDENTITY)
    middle = (HEIGHT // 2, WIDTH // 2)
    assert frames[0].depth[middle] == plain[0].depth[middle]
    assert not np.array_equal(frames[0].depth, plain[0].depth)


def test_where_frames_are_not_compared_depth_is_taken_as_it_is():
    frames, refusals = assemble(unregistered(), check_frame_ids=False)
    assert len(frames) == 4
    assert not refusals.counts


def half_sized(messages):
    """Depth of half the size, in the same frame as colour."""
    halved = []
    for one in messages:
        if one.role is Role.DEPTH:
            pixels = np.frombuffer(one.message.data, "<u2").reshape(HEIGHT, WIDTH)[::2, ::2]
            fields = {"height": HEIGHT // 2, "width": WIDTH // 2, "step": WIDTH}
            one = Recorded(one.role, replace(one.message, **fields, data=pixels.tobytes()))
        halved.append(one)
    return halved


HALF = (50.0, 0.0, WIDTH / 4, 0.0, 50.0, HEIGHT / 4, 0.0, 0.0, 1.0)


@pytest.mark.parametrize("is_late", [True, False])
def test_depth_of_another_size_in_colours_frame_is_registered_by_its_own_info(is_late):
    info = Recorded(
        Role.DEPTH_INFO, replace(info_message(0), width=WIDTH // 2, height=HEIGHT // 2, k=HALF)
    )
    messages = half_sized(recording(4))
    frames, refusals = assemble([*messages, info] if is_late else [info, *messages])
    assert not refusals.counts
    assert len(frames) == 4
    inner = np.abs(frames[0].depth - depth_of(0))[2:-2, 2:-2]
    assert np.median(inner) < 0.005


def test_depth_of_another_size_without_its_info_is_refused_naming_the_topic():
    cause, sentence = refused(half_sized(recording(4)))
    assert cause == "size"
    assert TOPICS[Role.DEPTH_INFO] in sentence


def test_a_leading_slash_makes_no_other_frame():
    slashed = [
        Recorded(one.role, replace(one.message, frame_id=f"/{one.message.frame_id}"))
        if one.role in (Role.DEPTH, Role.CAMERA_INFO)
        else one
        for one in recording(4)
    ]
    frames, refusals = assemble(slashed)
    assert not refusals.counts
    assert len(frames) == 4


def test_lengths_along_the_rays_become_depth():
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    length = np.sqrt(1 + ((columns - WIDTH / 2) / 100) ** 2 + ((rows - HEIGHT / 2) / 100) ** 2)
    rays = []
    for one in recording(2):
        if one.role is Role.DEPTH:
            pixels = np.frombuffer(one.message.data, "<u2").reshape(HEIGHT, WIDTH) * length
            data = pixels.round().astype("<u2").tobytes()
            one = Recorded(one.role, replace(one.message, data=data))
        rays.append(one)
    frames, _ = assemble(rays, depth_kind="ray")
    assert np.abs(frames[1].depth - depth_of(1)).max() < 0.002
