# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Wrong conventions, jumps and ray lengths are distinguished from right poses, and named."""

from dataclasses import replace

import numpy as np
import pytest

from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.pose import quaternion_of, rigid_matrix
from reflest_core.fusion.poses import check as check_module
from reflest_core.fusion.poses.agreement import DepthSample
from reflest_core.fusion.poses.check import PoseCheck
from reflest_core.fusion.poses.conventions import OPTICAL_IN_BODY, OPTICAL_IN_OPENGL

COARSE = 0.016
"""Relative standard deviation of coarse depth."""
MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])


@pytest.fixture(scope="module")
def frames():
    """Every second frame of the project's own capture, about 10 degrees apart."""
    return list(open_capture("captures/glossy-red"))[:50:2]


@pytest.fixture(scope="module")
def every_frame():
    """The project's own capture."""
    return list(open_capture("captures/glossy-red"))


def placed(frames, convention):
    return [replace(frame, T_world_camera=convention(frame.T_world_camera)) for frame in frames]


def report_of(frames):
    check = PoseCheck()
    for frame in frames:
        check.add(frame)
    return check.report


def moved(*shift):
    pose = np.eye(4)
    pose[:3, 3] = shift
    return pose


def read_as_wxyz(pose):
    """The pose of a quaternion whose parts were written in the order w, x, y, z."""
    x, y, z, w = quaternion_of(pose[:3, :3])
    return rigid_matrix(pose[:3, 3], np.array([w, x, y, z]))


def scaled(pose, factor):
    pose = pose.copy()
    pose[:3, 3] *= factor
    return pose


def test_right_poses_agree_and_nothing_is_said(frames):
    report = report_of(frames)
    assert report.pairs >= 8
    assert report.worst > 0.9
    assert report.jumps == 0
    assert report.problem == ""


@pytest.mark.parametrize(
    ("words", "convention"),
    [
        ("body frame", lambda pose: pose @ np.linalg.inv(OPTICAL_IN_BODY)),
        ("OpenGL camera", lambda pose: pose @ np.linalg.inv(OPTICAL_IN_OPENGL)),
        ("world-to-camera", np.linalg.inv),
        ("mirrored along y", lambda pose: MIRROR @ pose @ MIRROR),
        ("order w, x, y, z", read_as_wxyz),
        ("1000 times shorter", lambda pose: scaled(pose, 1000.0)),
        ("2 times longer", lambda pose: scaled(pose, 0.5)),
        ("1.25 times shorter", lambda pose: scaled(pose, 1.3)),
        (
            "world-to-camera, of the camera's body",
            lambda pose: np.linalg.inv(pose @ np.linalg.inv(OPTICAL_IN_BODY)),
        ),
        ("view matrices", lambda pose: OPTICAL_IN_OPENGL @ np.linalg.inv(pose)),
    ],
)
def test_a_wrong_convention_is_named(frames, words, convention):
    assert words in report_of(placed(frames, convention)).problem


def test_depth_in_another_unit_is_named(frames):
    report = report_of([replace(frame, depth=frame.depth * 5) for frame in frames])
    assert "capture.depth_scale" in report.problem
    assert "5 times longer" in report.problem


@pytest.mark.parametrize(("factor", "words"), [(2.0, "2 times shorter"), (0.5, "2 times longer")])
def test_focal_lengths_of_another_resolution_are_named(frames, factor, words):
    scaled_focal = [
        replace(
            frame,
            intrinsics=replace(
                frame.intrinsics,
                fx=factor * frame.intrinsics.fx,
                fy=factor * frame.intrinsics.fy,
            ),
        )
        for frame in frames
    ]
    problem = report_of(scaled_focal).problem
    assert "the focal lengths seem wrong" in problem
    assert words in problem


def jittered(frames, seed=0):
    """Poses off by .29 degrees and 3 mm an axis, differently in each frame."""
    noise = np.random.default_rng(seed)
    return placed(
        frames,
        lambda pose: (
            pose
            @ rigid_matrix(
                noise.normal(0.0, 0.003, 3), np.append(noise.normal(0.0, 0.005, 3) / 2.0, 1.0)
            )
        ),
    )


def late(frames, by=3):
    return [
        replace(frame, T_world_camera=frames[max(index - by, 0)].T_world_camera)
        for index, frame in enumerate(frames)
    ]


def test_positions_a_tenth_too_short_are_not_laid_to_the_focal_lengths(every_frame):
    problem = report_of(placed(every_frame, lambda pose: scaled(pose, 0.9))).problem
    assert "positions 1.1 times longer" in problem
    assert "focal" not in problem


def test_late_poses_are_a_problem_without_a_named_cause(every_frame):
    problem = report_of(late(every_frame)).problem
    assert "check the frame whose pose is given" in problem
    assert "focal" not in problem


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("stride", [1, 2, 3])
def test_jitter_of_poses_is_not_laid_to_the_focal_lengths(every_frame, stride, seed):
    assert "focal" not in report_of(jittered(every_frame, seed)[::stride]).problem


def test_three_poor_pairs_of_a_right_capture_are_no_problem(frames):
    """Depth too coarse for the tolerance: agreement .5 to .6 from three pairs, as of an arm."""
    noise = np.random.default_rng(4)
    coarse = [
        replace(
            frame,
            depth=(frame.depth * noise.normal(1.0, COARSE, frame.depth.shape)).astype(np.float32),
        )
        for frame in frames
    ]
    few, all_of_them = report_of(coarse[:4]), report_of(coarse)
    assert few.pairs == 3
    assert 0.5 < few.agreement < 0.58
    assert few.problem == ""
    assert all_of_them.pairs > 8
    assert "of the depth of frames meets" in all_of_them.problem


def test_poses_without_any_convention_still_have_a_problem(frames):
    noise = np.random.default_rng(3)
    astray = placed(frames, lambda pose: pose @ moved(*noise.normal(0.0, 0.1, 3)))
    assert "check the frame whose pose is given" in report_of(astray).problem


def test_lengths_along_the_rays_are_named(frames):
    camera = frames[0].intrinsics
    rows, columns = np.mgrid[: camera.height, : camera.width]
    length = np.hypot(
        1.0, np.hypot((columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy)
    )
    report = report_of(
        [replace(frame, depth=(frame.depth * length).astype(np.float32)) for frame in frames]
    )
    assert "capture.depth_kind to ray" in report.problem


def test_a_jump_is_confirmed_by_the_frame_after_it(frames):
    jumped = frames[:12] + placed(frames[12:], lambda pose: moved(0.05, 0.0, 0.05) @ pose)
    check = PoseCheck()
    answers = [check.add(frame) for frame in jumped]
    assert [index for index, answer in enumerate(answers) if answer is not None] == [13]
    assert answers[13] is jumped[12]
    assert check.report.jumps == 1
    assert "fusion.on_jump" in check.report.problem
    check.drop_before_jump(is_all=True)
    assert "was dropped" in check.report.problem


def test_one_bad_frame_is_no_jump(frames):
    frames = list(frames)
    frames[12] = placed([frames[12]], lambda pose: moved(0.05, 0.0, 0.05) @ pose)[0]
    assert report_of(frames).jumps == 0


def test_a_pair_without_common_surface_says_nothing(frames):
    here, there = DepthSample(frames[0]), DepthSample(frames[1])
    away = there.meets(here, moved(50.0, 0.0, 0.0))
    assert not away.is_known


def test_depth_with_gaps_in_a_grid_is_compared_too(frames):
    sparse = []
    for frame in frames[:2]:
        depth = np.zeros_like(frame.depth)
        depth[::2, ::2] = frame.depth[::2, ::2]
        sparse.append(DepthSample(replace(frame, depth=depth)))
    relative = np.linalg.inv(sparse[0].pose) @ sparse[1].pose
    agreement = sparse[1].meets(sparse[0], relative)
    assert agreement.is_known
    assert agreement.share > 0.9


def test_what_is_masked_away_may_move_as_it_likes(frames):
    """An object in a hand: the wall behind stays in the picture while the object turns."""
    held = []
    for frame in frames:
        mask = frame.depth > 0.0
        depth = np.where(mask, frame.depth, np.float32(0.9))
        held.append(replace(frame, depth=depth, mask=mask))
    assert report_of([replace(frame, mask=None) for frame in held]).problem
    report = report_of(held)
    assert report.problem == ""
    assert report.agreement > 0.9


def test_diagnostics_ask_for_the_agreement_without_trying_conventions(frames, monkeypatch):
    tried = []
    found = check_module.explanation_of
    monkeypatch.setattr(
        check_module, "explanation_of", lambda *given: tried.append(1) or found(*given)
    )
    check = PoseCheck()
    for frame in placed(frames, np.linalg.inv):
        check.add(frame)
    assert check.agreement < 0.6
    assert not tried
    assert check.report.agreement == check.agreement
    assert tried
