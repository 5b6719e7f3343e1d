# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A colour image that a driver repeats while pose and depth move is found; nothing else is."""

from dataclasses import replace

import numpy as np
import pytest

from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.poses.check import PoseCheck


@pytest.fixture(scope="module")
def frames():
    return list(open_capture("captures/glossy-red"))[:20]


def problem_of(frames):
    check = PoseCheck()
    for frame in frames:
        check.add(frame)
    return check.report.problem


def frozen(frames, start=0, stop=None):
    """The image of ``start`` in all frames from there to ``stop``."""
    held = [replace(frame, rgb=frames[start].rgb.copy()) for frame in frames[start:stop]]
    return frames[:start] + held + ([] if stop is None else frames[stop:])


def test_a_frozen_colour_stream_is_a_problem(frames):
    assert "in 19 frames while pose and depth moved" in problem_of(frozen(frames))


def test_a_driver_that_stalls_for_a_while_is_a_problem_too(frames):
    assert "the colour stream seems frozen" in problem_of(frozen(frames, 8, 14))


def test_the_estimate_has_the_sentence_in_its_status():
    pipeline = Pipeline(ReflestSettings())
    for frame in frozen(list(open_capture("captures/glossy-red"))[::3]):
        pipeline.fuse(frame)
    estimate = pipeline.estimate(pipeline.snapshot())
    assert estimate.status is EstimateStatus.INCONSISTENT_POSES
    assert "stayed the same to the byte" in estimate.status_text


def test_right_images_raise_nothing(frames):
    assert problem_of(frames) == ""


def test_an_image_that_comes_twice_is_no_frozen_stream(frames):
    pairs = [
        replace(frame, rgb=frames[index - index % 2].rgb) for index, frame in enumerate(frames)
    ]
    assert problem_of(pairs) == ""


def test_a_camera_that_stands_still_before_a_noise_free_scene_raises_nothing(frames):
    still = [replace(frames[0], stamp_ns=frame.stamp_ns) for frame in frames]
    assert problem_of(still) == ""


def test_images_that_show_one_colour_raise_nothing(frames):
    white = [replace(frame, rgb=np.full_like(frame.rgb, 255)) for frame in frames]
    assert problem_of(white) == ""


def test_a_rendering_that_shows_the_same_view_from_another_side_raises_nothing(frames):
    """As of a sphere in even light: colour and depth stay the same while the camera goes round."""
    same = [replace(frame, rgb=frames[0].rgb, depth=frames[0].depth) for frame in frames]
    assert "frozen" not in problem_of(same)


def test_after_a_restart_no_image_is_compared_with_those_before(frames):
    check = PoseCheck()
    for index, frame in enumerate(frozen(frames[:6])):
        if index % 3 == 0:
            check.restart()
        check.add(frame)
    assert check.report.problem == ""
