# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Wrong focal lengths, centres and scales are measured; right captures raise nothing."""

import re
from dataclasses import replace

import numpy as np
import pytest

from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.pose import rigid_matrix
from reflest_core.fusion.poses.check import PoseCheck


@pytest.fixture(scope="module", params=["captures/glossy-red", "captures/table"])
def frames(request):
    return list(open_capture(request.param))


def problem_of(frames):
    check = PoseCheck()
    for frame in frames:
        check.add(frame)
    return check.report.problem


def seen_by(frames, focal=1.0, right=0.0, down=0.0):
    """The frames with other intrinsics."""
    camera = frames[0].intrinsics
    camera = replace(
        camera,
        fx=focal * camera.fx,
        fy=focal * camera.fy,
        cx=camera.cx + right,
        cy=camera.cy + down,
    )
    return [replace(frame, intrinsics=camera) for frame in frames]


def posed(frames, change):
    return [replace(frame, T_world_camera=change(frame.T_world_camera)) for frame in frames]


@pytest.mark.parametrize(
    ("focal", "words"),
    [
        (0.75, "1.33"),
        (0.8, "1.25 times longer"),
        (0.85, "1.1"),
        (1.15, "1.15 times shorter"),
        (1.25, "1.25 times shorter"),
        (1.5, "1.5 times shorter"),
        (2.0, "2 times shorter"),
    ],
)
def test_wrong_focal_lengths_are_measured(frames, focal, words):
    problem = problem_of(seen_by(frames, focal))
    assert "focal lengths" in problem
    assert words in problem
    assert ("longer" in problem) == (focal < 1.0)
    assert "positions" not in problem


@pytest.mark.parametrize(
    ("right", "down", "words"),
    [(10, 0, "-10 (cx) and"), (0, -10, "+10 (cy)"), (-8, 6, "+8 (cx) and -6 (cy)")],
)
def test_a_wrong_centre_is_measured(frames, right, down, words):
    problem = problem_of(seen_by(frames, right=right, down=down))
    assert "a centre moved by" in problem
    assert words in problem


def test_a_wrong_scale_of_positions_is_measured(frames):
    scale = np.ones((4, 4))
    scale[:3, 3] = 0.9
    problem = problem_of(posed(frames, lambda pose: pose * scale))
    assert "positions 1.1" in problem
    assert "focal" not in problem


@pytest.mark.parametrize("place", [(0.05, 0.02, 0.0), (0.0, -0.02, 0.03), (0.0, 0.0, 0.06)])
def test_a_camera_mounted_elsewhere_is_measured(frames, place):
    """The poses are another frame's, in which the camera has this place."""
    mounting = np.eye(4)
    mounting[:3, 3] = place
    problem = problem_of(posed(frames, lambda pose: pose @ np.linalg.inv(mounting)))
    assert "a camera moved against its pose by" in problem
    measured = re.findall(r"([-+]\d\.\d{3}) \(", problem)
    np.testing.assert_allclose([float(one) for one in measured], place, atol=0.004)
    assert "capture.pose_to_camera" in problem


@pytest.mark.parametrize("seed", range(3))
def test_shaking_poses_are_not_laid_to_the_intrinsics(frames, seed):
    noise = np.random.default_rng(seed)
    shaking = posed(
        frames,
        lambda pose: (
            pose
            @ rigid_matrix(
                noise.normal(0.0, 0.003, 3), np.append(noise.normal(0.0, 0.005, 3) / 2.0, 1.0)
            )
        ),
    )
    problem = problem_of(shaking)
    assert "views far apart" not in problem


@pytest.mark.parametrize("by", [1, 2, 4])
def test_late_poses_are_not_laid_to_the_intrinsics(frames, by):
    late = [
        replace(frame, T_world_camera=frames[max(index - by, 0)].T_world_camera)
        for index, frame in enumerate(frames)
    ]
    problem = problem_of(late)
    assert "views far apart" not in problem


def test_after_a_jump_views_before_and_after_are_not_compared(frames):
    """Two halves that do not meet say nothing of the intrinsics."""
    jump = np.eye(4)
    jump[:3, 3] = 0.1, 0.0, 0.08
    half = len(frames) // 2
    problem = problem_of([*frames[:half], *posed(frames[half:], lambda pose: jump @ pose)])
    assert "the tracker jumped once" in problem
    assert "views far apart" not in problem
