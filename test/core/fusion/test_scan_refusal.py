# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A refused frame says why and leaves the scan as it was, bit for bit."""

import dataclasses

import numpy as np
import pytest

from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import OBJECT, look_at, orbit, orbit_frames, render
from test.core.fusion.scan_state import assert_same_arrays, state_of

REGION = RegionSettings("box", (0.0, 0.0, 0.0), (0.3, 0.3, 0.3))


def next_frame(**changes):
    frame = render([OBJECT], look_at(orbit(5, 24)), 9)
    return dataclasses.replace(frame, depth_source="/camera/depth", **changes)


def empty_depth():
    return next_frame(depth=np.zeros((120, 160), np.float32))


def nan_depth():
    return next_frame(depth=np.full((120, 160), np.nan, np.float32))


def beside_the_region():
    """The object is in sight, but all that has depth is the wall behind it."""
    return next_frame(depth=np.full((120, 160), 0.9, np.float32))


def far_from_the_region_as_in_tenths():
    """Depth ten times as large as it is."""
    frame = next_frame()
    return dataclasses.replace(frame, depth=10.0 * frame.depth)


def in_map_grid_coordinates():
    """A pose as UTM gives it, farther than the keys of voxels reach from where the scan began."""
    frame = next_frame()
    moved = frame.T_world_camera.copy()
    moved[:3, 3] += [500_000.0, 4_600_000.0, 0.0]
    return dataclasses.replace(frame, T_world_camera=moved)


def with_pose(x=0.0, scale=1.0):
    frame = next_frame()
    moved = frame.T_world_camera.copy()
    moved[0, 3] += x
    moved[:3, :3] *= scale
    return dataclasses.replace(frame, T_world_camera=moved)


NO_POSES = [
    (with_pose(np.nan), RefusalCause.POSE_INVALID, "NaN"),
    (with_pose(np.inf), RefusalCause.POSE_INVALID, "NaN or infinity"),
    (with_pose(2e7), RefusalCause.POSE_INVALID, "from the origin"),
    (with_pose(1e300), RefusalCause.POSE_INVALID, "from the origin"),
    (with_pose(scale=0.0), RefusalCause.POSE_INVALID, "orthonormal"),
    (with_pose(scale=np.nan), RefusalCause.POSE_INVALID, "NaN"),
]


def empty_mask():
    return next_frame(mask=np.zeros((120, 160), bool))


@pytest.mark.parametrize(
    ("frame", "cause", "words"),
    [
        (empty_depth(), RefusalCause.DEPTH_EMPTY, "/camera/depth"),
        (nan_depth(), RefusalCause.DEPTH_EMPTY, "/camera/depth"),
        (beside_the_region(), RefusalCause.NO_OVERLAP, "region of interest"),
        (
            far_from_the_region_as_in_tenths(),
            RefusalCause.NO_OVERLAP,
            r"pose's frame; depth there is about 10 times .*capture\.depth_scale",
        ),
        (empty_mask(), RefusalCause.NO_OVERLAP, "mask"),
        (
            in_map_grid_coordinates(),
            RefusalCause.POSE_INVALID,
            r"4600\.0 km from where the scan began",
        ),
        (next_frame(stamp_ns=99_000_000), RefusalCause.TIME_BACKWARDS, "reset"),
        (next_frame(stamp_ns=5), RefusalCause.TIME_BACKWARDS, "reset"),
        (next_frame(stamp_ns=2**70), RefusalCause.STAMP_INVALID, "within 292 years"),
        (next_frame(stamp_ns=-(2**63)), RefusalCause.STAMP_INVALID, "within 292 years"),
        *NO_POSES,
    ],
)
def test_refusal_names_its_cause_and_changes_nothing(frame, cause, words):
    scan = Scan(FusionSettings(max_depth=1.0), REGION)
    for earlier in orbit_frames(3):
        scan.fuse(earlier)
    before = state_of(scan)
    with pytest.raises(FrameRefused, match=words) as refused:
        scan.fuse(frame)
    assert refused.value.cause is cause
    assert_same_arrays(before, state_of(scan))
    scan.fuse(next_frame())


@pytest.mark.parametrize(("frame", "cause", "words"), NO_POSES)
def test_a_scan_does_not_begin_without_a_pose(frame, cause, words):
    scan = Scan(FusionSettings(max_depth=1.0), RegionSettings())
    with pytest.raises(FrameRefused, match=words) as refused:
        scan.fuse(frame)
    assert refused.value.cause is cause
    assert not scan.origin.any()


def test_a_scan_that_begins_as_far_away_as_scans_reach_can_be_loaded(tmp_path):
    scan = Scan(FusionSettings(max_depth=1.0), RegionSettings())
    scan.fuse(with_pose(9_999_999.0 - next_frame().camera_centre[0]))
    scan.save(tmp_path / "far.scan")
    loaded = Scan.load(tmp_path / "far.scan")
    assert loaded.voxel_count == scan.voxel_count > 0


def test_depth_of_next_to_nothing_is_not_blamed_on_depth_edges():
    scan = Scan(FusionSettings(max_depth=1.0), RegionSettings())
    tiny = next_frame(depth=np.full((120, 160), 1e-30, np.float32))
    with pytest.raises(FrameRefused, match=r"0\.02 m or more.*check its unit"):
        scan.fuse(tiny)


def test_nothing_inside_max_depth():
    scan = Scan(FusionSettings(max_depth=0.2), RegionSettings())
    with pytest.raises(FrameRefused, match="max_depth") as refused:
        scan.fuse(next_frame())
    assert refused.value.cause is RefusalCause.NO_OVERLAP
