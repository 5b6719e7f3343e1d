# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A frame that looks away from the scanned object still shows the light that falls on it."""

import dataclasses

import numpy as np
import pytest

from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.light.octahedral import octahedral_texel
from test.core.fusion.analytic_scene import OBJECT, look_at, orbit, orbit_frames, render
from test.core.fusion.scan_state import state_of

REGION = RegionSettings("box", (0.0, 0.0, 0.0), (0.3, 0.3, 0.3))
FUSION = FusionSettings(max_depth=1.0)
EYE, UP = np.array([0.5, 0.0, 0.0]), np.array([0.6, 0.2, 1.0])
RED = (200, 40, 20)


def looking_away(depth, stamp_ns=900_000_000):
    frame = render([OBJECT], look_at(tuple(EYE), tuple(UP)), 9, stamp_ns=stamp_ns)
    return dataclasses.replace(
        frame,
        rgb=np.full_like(frame.rgb, RED),
        depth=np.full(frame.depth.shape, depth, np.float32),
    )


def scanned():
    scan = Scan(FUSION, REGION)
    for frame in orbit_frames(3):
        scan.fuse(frame)
    return scan


def seen_along(scan, direction):
    """The light map's 8-bit colour there, None where unseen."""
    light = scan.light.observed()
    at = octahedral_texel(*direction.astype(float), len(light.coverage))
    return light.radiance[at] if light.coverage[at] else None


@pytest.mark.parametrize("depth", [0.0, 0.7, 3.0])
def test_only_the_light_is_taken(depth):
    scan = scanned()
    before = {
        name: array
        for name, array in state_of(scan).items()
        if "light" not in name and name != "numbers"
    }
    seen = scan.light.seen_share
    fused = scan.fuse(looking_away(depth))
    assert fused.is_light_alone
    assert fused.view is None
    assert scan.light.seen_share > seen
    after = state_of(scan)
    for name, array in before.items():
        np.testing.assert_array_equal(array, after[name], err_msg=name)


def test_it_lies_where_the_object_sees_it():
    far, near = scanned(), scanned()
    towards = UP - EYE
    far.fuse(looking_away(0.0))
    near.fuse(looking_away(3.0))
    assert seen_along(far, towards)[0] > 0.5
    wall = EYE + 3.0 * towards / np.linalg.norm(towards)
    assert seen_along(near, wall)[0] > 0.5


def test_before_anything_is_known_it_is_refused():
    with pytest.raises(FrameRefused, match="region of interest") as refused:
        Scan(FUSION, REGION).fuse(looking_away(0.7))
    assert refused.value.cause is RefusalCause.NO_OVERLAP


def test_a_depth_camera_that_fails_before_the_object_shows_no_light():
    scan = scanned()
    seen = scan.light.seen_share
    blind = render([OBJECT], look_at(orbit(5, 24)), 9)
    with pytest.raises(FrameRefused):
        scan.fuse(dataclasses.replace(blind, depth=np.zeros_like(blind.depth)))
    assert scan.light.seen_share == seen


def test_it_is_a_keyframe_whose_estimate_knows_more_of_the_light():
    pipeline = Pipeline(
        ReflestSettings(region=REGION, fusion=FUSION, estimation=EstimationSettings(min_voxels=1))
    )
    keyframes = [pipeline.fuse(frame).keyframe for frame in orbit_frames(6)]
    before = next(one for one in reversed(keyframes) if one is not None)
    after = pipeline.fuse(looking_away(0.0, stamp_ns=9_000_000_000)).keyframe
    assert after.surface.light.seen_share > before.surface.light.seen_share
    pipeline.estimate(after)
