# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Without a region one BRDF is that of the material in the middle of the view."""

import dataclasses

import numpy as np
import pytest

from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.pipeline import KeyframeSnapshot, Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.surface.selection import keep_voxels
from test.core.fusion.analytic_scene import Sphere, look_at, orbit, orbit_frames, render
from test.core.lit_table import BALLS, lit_table

SETTINGS = ReflestSettings(
    fusion=FusionSettings(max_depth=1.0, memory_budget_mb=32.0),
    estimation=EstimationSettings(),
)


@pytest.fixture(scope="module")
def table():
    found = lit_table(voxel=0.006, table=0.14)
    surface = dataclasses.replace(found.surface, keys=np.arange(1, len(found.labels) + 1))
    return dataclasses.replace(found, surface=surface)


@pytest.fixture(scope="module")
def pipeline():
    return Pipeline(SETTINGS)


def looking_at(table, point):
    return KeyframeSnapshot(5, "camera", table.surface, middle=np.array(point))


def top_of(ball):
    x, y, z = ball.centre
    return x, y, z + ball.radius


@pytest.mark.parametrize("ball", range(len(BALLS)))
def test_the_estimate_is_that_of_the_material_in_the_middle(pipeline, table, ball):
    estimate = pipeline.estimate(looking_at(table, top_of(BALLS[ball])))
    truth = np.array(table.materials[ball + 1].rho_d)
    assert estimate.status is not EstimateStatus.MIXED_MATERIALS
    # It is nearest to its own of all albedos, also where the light's strength errs.
    colours = np.array([one.rho_d for one in table.materials])
    log_colours = np.log(colours / colours.mean(axis=1, keepdims=True))
    found = np.log(np.array(estimate.rho_d) / np.mean(estimate.rho_d))
    assert np.linalg.norm(log_colours - found, axis=1).argmin() == ball + 1
    assert np.abs(np.log(np.mean(estimate.rho_d) / truth.mean())) < 0.5
    assert estimate.voxel_count < 0.3 * table.surface.voxel_count


def test_the_estimate_does_not_depend_on_what_was_estimated_before(pipeline, table):
    first = pipeline.estimate(looking_at(table, top_of(BALLS[0])))
    pipeline.estimate(looking_at(table, top_of(BALLS[1])))
    again = pipeline.estimate(looking_at(table, top_of(BALLS[0])))
    assert again.to_json() == first.to_json()


def test_of_one_material_it_is_the_estimate_of_the_whole(table):
    ball = keep_voxels(table.surface, np.flatnonzero(table.labels == 1))
    estimator = Estimator(SETTINGS.estimation)
    assert estimator.material_at(ball, np.array(top_of(BALLS[0])), 5, "camera") is None


NEAR, FAR = Sphere((0.0, 0.0, 0.0), 0.1), Sphere((0.35, 0.0, 0.0), 0.1)


def test_a_large_scan_is_estimated_around_the_middle():
    pipeline = Pipeline(SETTINGS)
    for frame in orbit_frames(8, (NEAR, FAR)):
        pipeline.fuse(frame)
    snapshot = pipeline.snapshot(most_voxels=400)
    assert snapshot.surface.voxel_count == snapshot.around.voxel_count == 400
    away = np.linalg.norm(snapshot.around.positions - snapshot.middle, axis=1)
    spread = np.linalg.norm(snapshot.surface.positions - snapshot.middle, axis=1)
    assert away.max() < 0.6 * spread.max()
    assert snapshot.around.light is snapshot.surface.light
    assert pipeline.snapshot().around is None


def test_a_keyframe_has_voxels_of_all_where_somebody_looks_at_them():
    fusion = dataclasses.replace(SETTINGS.fusion, voxel_size=0.0025, memory_budget_mb=128.0)
    for is_shown in (False, True):
        pipeline = Pipeline(dataclasses.replace(SETTINGS, fusion=fusion))
        pipeline.is_all_shown = lambda is_shown=is_shown: is_shown
        keyframes = [pipeline.fuse(frame).keyframe for frame in orbit_frames(8, (NEAR, FAR))]
        surface, around = keyframes[-1].surface, keyframes[-1].around
        away = np.linalg.norm(surface.positions - keyframes[-1].middle, axis=1)
        reach = np.linalg.norm(around.positions - keyframes[-1].middle, axis=1).max()
        assert (away.max() > 1.5 * reach) == is_shown


def test_a_saved_scan_keeps_its_middle(tmp_path):
    pipeline = Pipeline(SETTINGS)
    for view in range(6):
        pipeline.fuse(render((NEAR, FAR), look_at(orbit(view, 6)), view))
    pipeline.save(tmp_path / "scan")
    other = Pipeline(SETTINGS)
    other.load(tmp_path / "scan")
    assert other.snapshot().middle.tolist() == pipeline.snapshot().middle.tolist()
    assert np.linalg.norm(pipeline.snapshot().middle) == pytest.approx(NEAR.radius, abs=0.03)


def test_a_region_or_a_mask_says_what_is_looked_at():
    frame = orbit_frames(1)[0]
    region = RegionSettings("sphere", (0.0, 0.0, 0.0), (0.5, 0.5, 0.5))
    in_region, masked = Pipeline(dataclasses.replace(SETTINGS, region=region)), Pipeline(SETTINGS)
    in_region.fuse(frame)
    masked.fuse(dataclasses.replace(frame, mask=np.ones(frame.depth.shape, np.bool_)))
    assert in_region.snapshot().middle is masked.snapshot().middle is None
