# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The live path in one object: what an estimate says of the scan that it comes from."""

import dataclasses

import cv2
import numpy as np
import pytest

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.light.known_light import KnownLightError
from test.core.fusion.analytic_scene import (
    OBJECT,
    SMALL_CAMERA,
    look_at,
    orbit,
    orbit_frames,
    render,
)
from test.core.weight_files import untrained_lightnet

SETTINGS = ReflestSettings(
    fusion=FusionSettings(voxel_size=0.01, max_depth=1.0, memory_budget_mb=16.0),
    estimation=EstimationSettings(model="hemicnn"),
)


@pytest.fixture(scope="module")
def pipeline():
    pipeline = Pipeline(SETTINGS)
    for frame in orbit_frames(8):
        pipeline.fuse(frame)
    return pipeline


def test_counts_are_the_whole_scans_where_the_snapshot_is_a_part_of_it():
    pipeline = Pipeline(in_a_room(0)[0])
    for frame in orbit_frames(8):
        pipeline.fuse(frame)
    whole = pipeline.estimate(pipeline.snapshot())
    assert whole.voxel_count == pipeline.scan.store.observed_count
    assert whole.observation_count == pipeline.scan.observation_count
    assert whole.view_count == pipeline.scan.view_count
    part = pipeline.snapshot(most_voxels=100)
    assert part.surface.voxel_count == 100 < whole.voxel_count
    estimate = pipeline.estimate(part)
    assert estimate.voxel_count == whole.voxel_count
    assert estimate.observation_count == whole.observation_count


def test_frames_that_come_while_estimating_change_nothing(pipeline):
    frozen = pipeline.snapshot()
    expected = pipeline.estimate(frozen).to_json()
    for frame in orbit_frames(12)[8:]:
        pipeline.fuse(frame)
    assert pipeline.estimate(frozen).to_json() == expected
    assert pipeline.estimate(pipeline.snapshot()).to_json() != expected


CLOSE_UP = CameraIntrinsics(width=160, height=120, fx=900.0, fy=900.0, cx=79.5, cy=59.5)
"""In its images the sphere leaves no background."""


@pytest.mark.parametrize(("camera", "is_seen"), [(SMALL_CAMERA, True), (CLOSE_UP, False)])
def test_the_background_is_the_light_that_lightnet_knows(camera, is_seen, tmp_path):
    weights = str(untrained_lightnet(tmp_path))
    estimation = EstimationSettings("lightnet", weights, low_light=0.0)
    pipeline = Pipeline(dataclasses.replace(SETTINGS, estimation=estimation))
    for view in range(6):
        pipeline.fuse(render([OBJECT], look_at(orbit(view, 6)), view, camera))
    estimate = pipeline.estimate(pipeline.snapshot())
    assert ("none of the surroundings" in estimate.status_text) != is_seen
    pipeline.save(tmp_path / "scan")
    pipeline.load(tmp_path / "scan")
    assert pipeline.estimate(pipeline.snapshot()).to_json() == estimate.to_json()


def in_a_room(count):
    """Settings that tell the object from the room, and frames in which the room is not dark."""
    region = RegionSettings("sphere", (0.0, 0.0, 0.0), (0.3, 0.3, 0.3))
    estimation = dataclasses.replace(SETTINGS.estimation, low_coverage=0.0)
    settings = dataclasses.replace(SETTINGS, region=region, estimation=estimation)
    frames = orbit_frames(count)
    return settings, [dataclasses.replace(one, rgb=np.maximum(one.rgb, 60)) for one in frames]


def test_an_earlier_scan_of_the_room_stands_in_for_what_was_not_seen(tmp_path):
    """Two frames see little of the surroundings; eight frames before them saw more."""
    settings, frames = in_a_room(8)
    earlier = Pipeline(settings)
    for frame in frames:
        earlier.fuse(frame)
    earlier.save(tmp_path / "room")
    known = dataclasses.replace(settings.estimation, known_light=str(tmp_path / "room"))
    plain, helped = Pipeline(settings), Pipeline(dataclasses.replace(settings, estimation=known))
    for frame in frames[:2]:
        plain.fuse(frame)
        helped.fuse(frame)
    alone, joined = plain.snapshot(), helped.snapshot()
    before = earlier.snapshot().surface.light
    assert joined.light_problem == ""
    assert 0.0 < alone.surface.light.seen_share < before.seen_share
    assert joined.surface.light.seen_share == pytest.approx(before.seen_share, abs=0.01)
    np.testing.assert_array_equal(joined.surface.colours, alone.surface.colours)


def test_light_that_does_not_fit_is_a_warning_and_changes_nothing(tmp_path):
    noise = np.exp(np.random.default_rng(0).normal(0.0, 2.0, (32, 64, 3))).astype(np.float32)
    cv2.imwrite(str(tmp_path / "elsewhere.hdr"), noise)
    settings, frames = in_a_room(4)
    known = dataclasses.replace(settings.estimation, known_light=str(tmp_path / "elsewhere.hdr"))
    plain, misled = Pipeline(settings), Pipeline(dataclasses.replace(settings, estimation=known))
    for frame in frames:
        plain.fuse(frame)
        misled.fuse(frame)
    truth, found = (one.estimate(one.snapshot()) for one in (plain, misled))
    assert found.rho_d == truth.rho_d
    assert found.status is EstimateStatus.LOW_LIGHT
    assert "estimation.known_light does not look like what the camera saw" in found.status_text


def test_known_light_that_is_not_there_stops_the_start(tmp_path):
    path = str(tmp_path / "nothing.hdr")
    known = dataclasses.replace(SETTINGS.estimation, known_light=path)
    with pytest.raises(KnownLightError, match=r"nothing\.hdr cannot be read"):
        Pipeline(dataclasses.replace(SETTINGS, estimation=known))
