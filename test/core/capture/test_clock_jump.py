# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A clock that jumps back: told once, what waits is dropped, and the next frames come out.

The first message far back may be a mistake, so that a jump costs the frame it belongs to.
"""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.messages import PoseMessage, Role, TransformsMessage
from reflest_core.capture.refusal import RefusalCause
from reflest_core.capture.settings import CaptureSettings
from test.core.capture.recording import PERIOD_NS, TOPICS, Recorded, changed, recording, stamp


class Rig:
    def __init__(self, **values):
        self.jumps = []
        self.assembler = FrameAssembler(
            CaptureSettings(**values), TOPICS, on_clock_jump=self.jumps.append
        )

    def stamps(self, messages):
        frames = [frame for one in messages for frame in self.assembler.add(one.role, one.message)]
        return [frame.stamp_ns for frame in frames]

    @property
    def counts(self):
        return {cause.value: count for cause, count in self.assembler.refusals.counts.items()}


def later(messages, seconds):
    return [
        Recorded(one.role, replace(one.message, stamp_ns=one.message.stamp_ns + seconds * 10**9))
        for one in messages
    ]


def test_a_bag_that_starts_again_goes_on():
    rig = Rig()
    rig.stamps(later(recording(4), 100))
    assert rig.stamps(recording(4)) == [stamp(index) for index in (1, 2, 3)]
    assert rig.counts == {"clock_jump": 1, "time_backwards": 1, "pose_missing": 1}
    (sentence,) = rig.jumps
    for word in (TOPICS[Role.RGB], "105.100 s", "5.000 s", "capture.clock_jump"):
        assert word in sentence
    assert sentence == rig.assembler.refusals.first_message[RefusalCause.CLOCK_JUMP]


def test_what_waited_is_dropped_and_counted():
    rig = Rig()
    messages = later(recording(4), 100)
    rig.stamps([one for one in messages if one.role is not Role.DEPTH])
    assert rig.stamps(recording(3)) == [stamp(1), stamp(2)]
    assert rig.counts == {"clock_jump": 1, "time_backwards": 4 + 1, "pose_missing": 1}


def test_a_calibration_that_was_latched_serves_after_the_jump():
    rig = Rig()
    rig.stamps(later(recording(2), 100))
    without_info = [one for one in recording(2) if one.role is not Role.CAMERA_INFO]
    assert rig.stamps(without_info) == [stamp(1)]


def test_a_smaller_step_back_is_late_and_no_jump():
    rig = Rig(clock_jump=10.0)
    rig.stamps(later(recording(3), 5))
    assert rig.stamps(recording(3)) == []
    assert rig.jumps == []
    assert set(rig.counts) == {"time_backwards"}


@pytest.mark.parametrize("role", [Role.RGB, Role.DEPTH, Role.POSE])
@pytest.mark.parametrize("wrong_ns", [(2**31 - 1) * 10**9, 0])
def test_one_wrong_stamp_is_no_jump_and_costs_few_frames(role, wrong_ns):
    rig = Rig()
    messages = changed(recording(12), role, 3, stamp_ns=wrong_ns)
    frames = rig.stamps(messages)
    assert rig.jumps == []
    assert len(frames) >= 9
    assert frames[-6:] == [stamp(index) for index in range(6, 12)]
    assert "time_backwards" in rig.counts


def test_a_negative_stamp_is_refused_by_name():
    rig = Rig()
    rig.stamps(changed(recording(2), Role.DEPTH, 0, stamp_ns=-1))
    assert rig.counts["stamp_invalid"] == 1
    assert "header.stamp" in rig.assembler.refusals.first_message[RefusalCause.STAMP_INVALID]


def test_transforms_start_again_too():
    rig = Rig(pose_source="tf")

    def as_tf(messages):
        return [
            Recorded(
                Role.TF,
                TransformsMessage(
                    (
                        PoseMessage(
                            one.message.stamp_ns,
                            "map",
                            one.message.position,
                            one.message.orientation,
                            "camera_color_optical_frame",
                        ),
                    )
                ),
            )
            if one.role is Role.POSE
            else one
            for one in messages
        ]

    rig.stamps(as_tf(later(recording(3), 100)))
    assert rig.stamps(as_tf(recording(3)))[-2:] == [stamp(1), stamp(2)]
    assert len(rig.jumps) == 1


def test_a_world_frame_that_changes_is_refused_until_a_reset():
    rig = Rig()
    messages = recording(4)
    for index in (2, 3):
        messages = changed(messages, Role.POSE, index, frame_id="odom")
    assert rig.stamps(messages) == [stamp(0), stamp(1)]
    assert rig.counts == {"frame_mismatch": 2}
    rig.assembler.reset()
    assert rig.stamps(messages[8:]) == [stamp(2), stamp(3)]


def test_another_cameras_calibration_is_refused():
    rig = Rig()
    messages = changed(recording(2), Role.CAMERA_INFO, 0, frame_id="camera_infra1_optical_frame")
    assert rig.stamps(messages) == [stamp(1)]
    assert "camera_infra1" in rig.assembler.refusals.first_message[RefusalCause.FRAME_MISMATCH]


@settings(max_examples=50)
@given(st.lists(st.tuples(st.sampled_from([*TOPICS]), st.integers(0, 2**62)), max_size=20))
def test_after_any_stamps_good_frames_come_out_once_time_has_gone_on_by_a_jump(stamps):
    """A stamp less than a jump ahead makes those before it late: here, three frames."""
    rig = Rig(clock_jump=3 * PERIOD_NS * 1e-9)
    templates = {one.role: one.message for one in recording(1)}
    rig.stamps([Recorded(role, replace(templates[role], stamp_ns=ns)) for role, ns in stamps])
    frames = rig.stamps(recording(12))
    assert frames[-6:] == [stamp(index) for index in range(6, 12)]
