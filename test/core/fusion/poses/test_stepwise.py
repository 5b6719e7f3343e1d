# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Long computations are spread over frames, and end the same."""

from dataclasses import replace
from pathlib import Path

import pytest

from reflest_core.capture.open_capture import open_capture
from reflest_core.fusion.poses.check import PoseCheck
from reflest_core.fusion.poses.stepwise import StepwiseWork

CAPTURES = Path(__file__).parents[4] / "captures"


def counting(done, count):
    for number in range(count):
        done.append(number)
        yield


def test_a_frame_does_no_more_steps_than_its_share():
    work, done = StepwiseWork(), []
    work.start(counting(done, 5))
    work.advance(2)
    assert done == [0, 1]
    assert work.is_running
    work.advance(9)
    assert done == [0, 1, 2, 3, 4]
    assert not work.is_running


def test_finishing_does_what_is_left_and_cancelling_does_not():
    work, done = StepwiseWork(), []
    work.start(counting(done, 3))
    work.finish()
    work.start(counting(done, 3))
    work.cancel()
    work.finish()
    assert done == [0, 1, 2]


@pytest.fixture(scope="module")
def short_focal_length():
    frames = []
    for frame in open_capture(CAPTURES / "glossy-red"):
        camera = frame.intrinsics
        wrong = replace(camera, fx=0.85 * camera.fx, fy=0.85 * camera.fy)
        frames.append(replace(frame, intrinsics=wrong))
    return frames


def test_a_wrong_focal_length_is_named_while_frames_come(short_focal_length):
    check, named = PoseCheck(), []
    for number, frame in enumerate(short_focal_length):
        check.add(frame)
        if "under focal lengths" in check.latest_report.problem:
            named.append(number)
    assert named
    assert named[0] < 45  # and not at the end alone, where all that is left is done


def test_a_full_report_does_not_change_when_asked_for_again(short_focal_length):
    check = PoseCheck()
    for frame in short_focal_length[:30]:
        check.add(frame)
    assert check.report == check.report == check.latest_report
