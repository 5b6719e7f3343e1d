# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Matching in time: nearest depth, bracketing poses, and no dependence on the order of arrival."""

import random
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reflest_core.capture.messages import (
    CameraInfoMessage,
    ImageMessage,
    PoseMessage,
    Role,
)
from reflest_core.capture.refusal import RefusalCause, RefusalLog
from reflest_core.capture.settings import CaptureSettings
from reflest_core.capture.sync.depth_alignment import DepthAlignment
from reflest_core.capture.sync.matching import Matcher
from reflest_core.capture.sync.transform_buffer import TransformBuffer

MS = 10**6
TOPICS = {role: f"/{role.value}" for role in Role}
K = (500.0, 0.0, 320.0, 0.0, 510.0, 240.0, 0.0, 0.0, 1.0)


def image(stamp_ms):
    return ImageMessage(stamp_ms * MS, "camera", 1, 1, "mono8", False, 1, b"\0")


def pose(stamp_ms):
    return PoseMessage(stamp_ms * MS, "world", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def info(stamp_ms=0, width=640):
    return CameraInfoMessage(stamp_ms * MS, "camera", width, 480, K)


def _matcher(values, refuse, on_clock_jump=lambda _: None):
    transforms = TransformBuffer(values.max_transform_gap, values.clock_jump)
    alignment = DepthAlignment(values, TOPICS, transforms)
    return Matcher(values, TOPICS, refuse, transforms, alignment, on_clock_jump)


class Rig:
    """A matcher with its refusals; stamps go in and come out in milliseconds."""

    def __init__(self, **values):
        self.log = RefusalLog()
        self.matcher = _matcher(CaptureSettings(**values), self.log.add)

    def add(self, role, *messages):
        return [match for one in messages for match in self.matcher.add(role, one)]

    @property
    def causes(self):
        return {cause: count for cause, count in self.log.counts.items() if count}


def stamps(matches):
    return [
        (
            match.rgb.stamp_ns // MS,
            match.depth.stamp_ns // MS,
            match.pose_before.stamp_ns // MS,
            match.pose_after.stamp_ns // MS,
        )
        for match in matches
    ]


def test_equal_stamps_match_as_soon_as_the_last_comes():
    rig = Rig()
    assert rig.add(Role.CAMERA_INFO, info()) == []
    assert rig.add(Role.POSE, pose(10)) == []
    assert rig.add(Role.DEPTH, image(10)) == []
    assert stamps(rig.add(Role.RGB, image(10))) == [(10, 10, 10, 10)]


def test_the_nearest_depth_is_taken_even_if_it_comes_later():
    rig = Rig()
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.POSE, pose(90), pose(110))
    rig.add(Role.DEPTH, image(91))
    assert rig.add(Role.RGB, image(100)) == [], "a nearer depth may still come"
    assert stamps(rig.add(Role.DEPTH, image(104))) == [(100, 104, 90, 110)]


def test_of_two_depths_as_near_the_earlier_is_taken():
    rig = Rig()
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.POSE, pose(100))
    rig.add(Role.RGB, image(100))
    assert stamps(rig.add(Role.DEPTH, image(95), image(105))) == [(100, 95, 100, 100)]


def test_depth_beyond_the_slop_is_missing_and_the_sentence_says_how_far():
    rig = Rig(slop=0.02)
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.POSE, pose(100))
    rig.add(Role.RGB, image(100))
    assert rig.add(Role.DEPTH, image(79), image(121)) == []
    assert rig.causes == {RefusalCause.DEPTH_MISSING: 1}
    sentence = rig.log.first_message[RefusalCause.DEPTH_MISSING]
    assert "/depth" in sentence
    assert "21.0 ms" in sentence
    assert "capture.slop" in sentence


def test_zero_slop_demands_equal_stamps():
    rig = Rig(slop=0.0)
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.POSE, pose(0), pose(50), pose(100))
    rig.add(Role.RGB, image(50), image(60))
    matched = rig.add(Role.DEPTH, image(50), image(61))
    assert stamps(matched) == [(50, 50, 50, 50)]
    assert rig.causes == {RefusalCause.DEPTH_MISSING: 1}


def test_poses_too_far_apart_are_not_interpolated():
    rig = Rig(max_pose_gap=0.05)
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.DEPTH, image(100), image(200))
    rig.add(Role.RGB, image(100), image(200))
    matched = rig.add(Role.POSE, pose(75), pose(125), pose(180), pose(231))
    assert stamps(matched) == [(100, 100, 75, 125)]
    assert rig.causes == {RefusalCause.POSE_MISSING: 1}
    assert "capture.max_pose_gap" in rig.log.first_message[RefusalCause.POSE_MISSING]


def test_before_the_first_pose_there_is_none():
    rig = Rig()
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.DEPTH, image(100))
    rig.add(Role.RGB, image(100))
    assert rig.add(Role.POSE, pose(101)) == []
    assert rig.causes == {RefusalCause.POSE_MISSING: 1}


def test_one_calibration_serves_all_images_and_a_change_counts_from_its_stamp():
    rig = Rig()
    rig.add(Role.DEPTH, image(10), image(20), image(30))
    rig.add(Role.POSE, pose(10), pose(20), pose(30))
    rig.add(Role.CAMERA_INFO, info(15), info(25, width=320))
    matched = rig.add(Role.RGB, image(10), image(20), image(30))
    assert [match.camera_info.width for match in matched] == [640, 640, 320]


def test_flush_refuses_what_can_no_longer_match():
    rig = Rig()
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.POSE, pose(100), pose(200))
    rig.add(Role.DEPTH, image(95), image(205))
    rig.add(Role.RGB, image(200), image(210), image(300))
    assert stamps(rig.matcher.flush()) == []
    assert rig.causes == {RefusalCause.POSE_MISSING: 1, RefusalCause.DEPTH_MISSING: 1}


def test_flush_matches_the_last_image_with_an_earlier_depth():
    rig = Rig()
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.POSE, pose(100))
    rig.add(Role.DEPTH, image(95))
    assert rig.add(Role.RGB, image(100)) == []
    assert stamps(rig.matcher.flush()) == [(100, 95, 100, 100)]


@pytest.mark.parametrize("second", [5, 10])
@pytest.mark.parametrize("role", [Role.RGB, Role.DEPTH, Role.POSE])
def test_a_stamp_that_does_not_advance_is_refused(role, second):
    rig = Rig()
    make = pose if role is Role.POSE else image
    rig.add(role, make(10), make(second))
    assert rig.causes == {RefusalCause.TIME_BACKWARDS: 1}
    assert f"/{role.value}" in rig.log.first_message[RefusalCause.TIME_BACKWARDS]


def test_after_a_reset_time_may_start_again():
    rig = Rig()
    for start in (1000, 0):
        rig.add(Role.CAMERA_INFO, info(start))
        rig.add(Role.POSE, pose(start))
        rig.add(Role.DEPTH, image(start))
        assert len(rig.add(Role.RGB, image(start))) == 1
        rig.matcher.reset()
    assert rig.causes == {}


@pytest.mark.parametrize(
    ("absent", "cause"),
    [
        (Role.CAMERA_INFO, RefusalCause.CAMERA_INFO_MISSING),
        (Role.DEPTH, RefusalCause.DEPTH_MISSING),
        (Role.POSE, RefusalCause.POSE_MISSING),
    ],
)
def test_a_topic_that_never_comes_is_named(absent, cause):
    rig = Rig(queue_size=5, pose_queue_size=5)
    makers = {Role.CAMERA_INFO: info, Role.DEPTH: image, Role.POSE: pose}
    for stamp in range(5):
        for role, make in makers.items():
            if role is not absent:
                rig.add(role, make(stamp))
        rig.add(Role.RGB, image(stamp))
    assert rig.causes == {}
    rig.add(Role.RGB, image(5))
    assert rig.causes == {cause: 1}
    assert f"/{absent.value}" in rig.log.first_message[cause]


def test_a_topic_that_lags_fills_the_queue_and_is_named():
    rig = Rig(queue_size=4)
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.POSE, *map(pose, range(0, 100, 10)))
    rig.add(Role.DEPTH, image(0))
    rig.add(Role.RGB, *[image(10 * index + 5) for index in range(6)])
    assert rig.causes == {RefusalCause.QUEUE_FULL: 2}
    sentence = rig.log.first_message[RefusalCause.QUEUE_FULL]
    assert "/depth" in sentence
    assert "capture.queue_size" in sentence


def test_masks_are_waited_for_where_they_are_used():
    rig = Rig(use_mask=True)
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.POSE, pose(10), pose(60))
    rig.add(Role.DEPTH, image(10), image(60))
    assert rig.add(Role.RGB, image(10), image(60)) == []
    (match,) = rig.add(Role.MASK, image(10))
    assert match.mask.stamp_ns == 10 * MS
    assert rig.add(Role.MASK, image(90)) == []
    assert rig.causes == {RefusalCause.MASK_MISSING: 1}


def streams(draw):
    """Four topics with their own rates, jitter and gaps; stamps rise in each."""
    steps = st.lists(st.integers(1, 40), min_size=1, max_size=25)

    def rising(start):
        total = start
        for step in draw(steps):
            total += step
            yield total

    return {
        Role.RGB: [image(stamp) for stamp in rising(draw(st.integers(0, 30)))],
        Role.DEPTH: [image(stamp) for stamp in rising(draw(st.integers(0, 30)))],
        Role.POSE: [pose(stamp) for stamp in rising(draw(st.integers(0, 30)))],
        Role.CAMERA_INFO: [info(stamp) for stamp in rising(0)],
    }


def interleaved(topics, seed):
    """Any order across topics that keeps the order within each."""
    queues = {role: list(messages) for role, messages in topics.items()}
    shuffle = random.Random(seed)
    while any(queues.values()):
        role = shuffle.choice([role for role, queue in queues.items() if queue])
        yield role, queues[role].pop(0)


def outcome(messages):
    rig = Rig()
    matches = [match for role, one in messages for match in rig.matcher.add(role, one)]
    return stamps([*matches, *rig.matcher.flush()]), rig.causes


@settings(max_examples=300)
@given(st.data(), st.integers(0, 2**32))
def test_the_order_of_arrival_across_topics_changes_nothing(data, seed):
    topics = streams(data.draw)
    in_order = sorted(
        ((role, one) for role, queue in topics.items() for one in queue),
        key=lambda item: item[1].stamp_ns,
    )
    assert outcome(interleaved(topics, seed)) == outcome(in_order)


@settings(max_examples=200)
@given(st.data())
def test_every_image_is_matched_or_refused_and_matches_are_right(data):
    topics = streams(data.draw)
    matched, causes = outcome(interleaved(topics, 0))
    assert len(matched) + sum(causes.values()) == len(topics[Role.RGB])
    depths = [message.stamp_ns // MS for message in topics[Role.DEPTH]]
    for rgb, depth, before, after in matched:
        assert abs(depth - rgb) == min(abs(other - rgb) for other in depths) <= 20
        assert before <= rgb <= after
    assert [match[0] for match in matched] == sorted({match[0] for match in matched})


@given(st.integers(1, 5))
def test_repeated_calibration_takes_no_room(count):
    rig = Rig(queue_size=2)
    for stamp in range(10 * count):
        rig.add(Role.CAMERA_INFO, replace(info(), stamp_ns=stamp))
    assert rig.causes == {}


def test_depth_that_piles_up_because_poses_lag_does_not_blame_colour():
    rig = Rig(queue_size=4)
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.POSE, pose(0))
    for stamp in range(10, 80, 10):
        rig.add(Role.RGB, image(stamp))
        rig.add(Role.DEPTH, image(stamp - 3), image(stamp))
    assert set(rig.causes) == {RefusalCause.QUEUE_FULL}
    assert "/pose (pose) has only come as far" in rig.log.first_message[RefusalCause.QUEUE_FULL]


def test_an_image_is_given_up_when_colour_is_far_ahead_of_it():
    rig = Rig(max_wait=0.5)
    rig.add(Role.CAMERA_INFO, info())
    rig.add(Role.POSE, pose(100), pose(900))
    rig.add(Role.RGB, image(100), image(600))
    assert rig.causes == {}
    rig.add(Role.RGB, image(601))
    assert rig.causes == {RefusalCause.DEPTH_MISSING: 1}


def test_a_calibration_said_again_with_an_earlier_stamp_is_in_force_earlier():
    """One wrong calibration with a right one stamped far ahead must not stay in force."""
    rig = Rig()
    rig.add(Role.CAMERA_INFO, info(10, width=1), info(900), info(20))
    rig.add(Role.DEPTH, image(15), image(30))
    rig.add(Role.POSE, pose(15), pose(30))
    matched = rig.add(Role.RGB, image(15), image(30))
    assert [match.camera_info.width for match in matched] == [1, 640]
