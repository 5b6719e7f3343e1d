# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a scan says of its poses reaches the estimate; a jump of the tracker follows the policy."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import KDTree

from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.settings import FusionSettings
from test.core.fusion.scan_state import assert_same_arrays, state_of

JUMP = np.eye(4)
JUMP[:3, 3] = (0.05, 0.03, 0.0)


@pytest.fixture(scope="module")
def frames():
    """Frames of the project's own capture, of which the last half are 6 cm off."""
    whole = list(open_capture("captures/glossy-red"))[:36:2]
    return whole[:9] + [
        replace(frame, T_world_camera=JUMP @ frame.T_world_camera) for frame in whole[9:]
    ]


def scanned(frames, **fusion):
    pipeline = Pipeline(ReflestSettings(fusion=FusionSettings(**fusion)))
    for frame in frames:
        pipeline.fuse(frame)
    return pipeline


def test_after_a_jump_the_scan_is_that_of_the_frames_after_it(frames):
    pipeline = scanned(frames)
    assert_same_arrays(state_of(pipeline.scan), state_of(scanned(frames[9:]).scan))
    estimate = pipeline.estimate(pipeline.snapshot())
    assert estimate.status is EstimateStatus.INCONSISTENT_POSES
    assert estimate.status_text.startswith("the tracker jumped once")
    assert "was dropped" in estimate.status_text


def test_keep_goes_on_in_the_same_scan_and_says_that_it_is_mixed(frames):
    pipeline = scanned(frames, on_jump="keep")
    assert pipeline.scan.view_count == len(frames)
    assert "mixed" in pipeline.estimate(pipeline.snapshot()).status_text


def test_drop_keeps_what_later_frames_confirm_and_no_ghosts(frames):
    """Past the object's outline the capture has no depth, and nothing contradicts ghosts there."""
    new = KDTree(scanned(frames[9:]).snapshot().surface.positions)

    def ghosts(policy):
        positions = scanned(frames, on_jump=policy).snapshot().surface.positions
        return (new.query(positions)[0] > 0.01).mean()

    assert ghosts("keep") > 0.4
    assert ghosts("drop") < 0.5 * ghosts("keep")


def test_drop_goes_on_in_the_same_scan_and_latches_the_jump(frames):
    pipeline = scanned(frames, on_jump="drop")
    assert pipeline.scan.view_count > len(frames) - 9
    estimate = pipeline.estimate(pipeline.snapshot())
    assert estimate.status is EstimateStatus.INCONSISTENT_POSES
    assert "contradict" in estimate.status_text
    assert pipeline.poses.jumps == 1


@pytest.fixture(scope="module")
def localised():
    """Frames of a tracker that starts at identity, then goes to far coordinates."""
    far = np.eye(4)
    far[:3, 3] = (5e5, 4.6e6, 120.0)
    whole = list(open_capture("captures/glossy-red"))[:12]
    return whole[:3] + [
        replace(frame, T_world_camera=far @ frame.T_world_camera) for frame in whole[3:]
    ]


def fused_where_possible(frames, **fusion):
    """A scan, and the indices of the frames that were refused."""
    pipeline, refused = Pipeline(ReflestSettings(fusion=FusionSettings(**fusion))), []
    for index, frame in enumerate(frames):
        try:
            pipeline.fuse(frame)
        except FrameRefused as refusal:
            assert refusal.cause is RefusalCause.POSE_INVALID
            refused.append(index)
    return pipeline, refused


def test_a_new_scan_begins_where_the_tracker_localises_far_away(localised):
    pipeline, refused = fused_where_possible(localised)
    assert refused == [3]
    assert_same_arrays(state_of(pipeline.scan), state_of(scanned(localised[3:]).scan))
    assert np.abs(pipeline.scan.origin - (5e5, 4.6e6, 120.0)).max() < 5.0
    assert "was dropped" in pipeline.snapshot().poses.problem


@pytest.mark.parametrize("policy", ["drop", "keep"])
def test_a_scan_that_goes_on_out_of_reach_says_that_the_tracker_jumped(localised, policy):
    pipeline, refused = fused_where_possible(localised, on_jump=policy)
    assert refused == list(range(3, 12))
    estimate = pipeline.estimate(pipeline.snapshot())
    assert estimate.status is EstimateStatus.INCONSISTENT_POSES
    assert estimate.status_text.startswith("the tracker jumped once")


@pytest.mark.parametrize("scale", [0.0, np.nan, 1e8], ids=["singular", "NaN", "out of reach"])
def test_poses_that_are_none_neither_jump_nor_cost_the_scan(localised, scale):
    frames = localised[:3] + [
        replace(frame, T_world_camera=frame.T_world_camera * scale) for frame in localised[3:]
    ]
    pipeline, refused = fused_where_possible(frames)
    assert refused == list(range(3, 12))
    assert_same_arrays(state_of(pipeline.scan), state_of(scanned(frames[:3]).scan))
    assert pipeline.poses.jumps == 0


def test_a_reset_forgets_the_jump(frames):
    pipeline = scanned(frames)
    pipeline.reset()
    for frame in frames[12:]:
        pipeline.fuse(frame)
    assert pipeline.snapshot().poses.problem == ""


def test_right_poses_leave_the_status_to_the_rest(frames):
    pipeline = scanned(frames[:9])
    assert pipeline.snapshot().poses.problem == ""
    estimate = pipeline.estimate(pipeline.snapshot())
    assert estimate.status is not EstimateStatus.INCONSISTENT_POSES
    assert estimate.depth_agreement > 0.95


def test_every_material_of_a_scan_with_wrong_poses_says_so(frames):
    pipeline = scanned(frames, on_jump="keep")
    estimates = [one.estimate for one in pipeline.materials(pipeline.snapshot()).materials]
    assert {one.status for one in estimates} == {EstimateStatus.INCONSISTENT_POSES}
    assert all(len(one.status_text) <= 512 for one in estimates)
