# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The live path in one object: what an estimate says of the scan that it comes from."""

import dataclasses

import pytest

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.estimation.scanner import Scanner
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.fusion import snapshot
from reflest_core.fusion.settings import FusionSettings
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
def scanner():
    scanner = Scanner(SETTINGS)
    for frame in orbit_frames(8):
        scanner.fuse(frame)
    return scanner


def test_counts_are_the_whole_scans_where_the_snapshot_is_a_part_of_it(scanner, monkeypatch):
    whole = scanner.estimate(scanner.snapshot())
    assert whole.voxel_count == scanner.scan.store.observed_count
    assert whole.observation_count == scanner.scan.observation_count
    assert whole.view_count == scanner.scan.view_count
    monkeypatch.setattr(snapshot, "MOST_VOXELS", 100)
    part = scanner.snapshot()
    assert part.surface.voxel_count == 100 < whole.voxel_count
    estimate = scanner.estimate(part)
    assert estimate.voxel_count == whole.voxel_count
    assert estimate.observation_count == whole.observation_count


def test_frames_that_come_while_estimating_change_nothing(scanner):
    frozen = scanner.snapshot()
    expected = scanner.estimate(frozen).to_json()
    for frame in orbit_frames(12)[8:]:
        scanner.fuse(frame)
    assert scanner.estimate(frozen).to_json() == expected
    assert scanner.estimate(scanner.snapshot()).to_json() != expected


CLOSE_UP = CameraIntrinsics(width=160, height=120, fx=900.0, fy=900.0, cx=79.5, cy=59.5)
"""In its images the sphere leaves no background."""


@pytest.mark.parametrize(("camera", "is_seen"), [(SMALL_CAMERA, True), (CLOSE_UP, False)])
def test_the_background_is_the_light_that_lightnet_knows(camera, is_seen, tmp_path):
    weights = str(untrained_lightnet(tmp_path))
    estimation = EstimationSettings("lightnet", weights, low_light=0.0, low_gloss=0.0)
    scanner = Scanner(dataclasses.replace(SETTINGS, estimation=estimation))
    for view in range(6):
        scanner.fuse(render([OBJECT], look_at(orbit(view, 6)), view, camera))
    estimate = scanner.estimate(scanner.snapshot())
    assert ("none of the surroundings" in estimate.status_text) != is_seen
    scanner.save(tmp_path / "scan")
    scanner.load(tmp_path / "scan")
    assert scanner.estimate(scanner.snapshot()).to_json() == estimate.to_json()
