# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Poses in map grids such as UTM: the same scan, in the user's frame, to the millimetre."""

import dataclasses

import numpy as np
import pytest
from plyfile import PlyData

from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.export.material_ply import export_materials
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import OBJECT, orbit_frames

UTM = np.array([500_123.0, 4_600_321.0, 212.0])  # whole voxels away
SETTINGS = ReflestSettings(
    fusion=FusionSettings(voxel_size=0.005, max_depth=1.0, memory_budget_mb=32.0),
    estimation=EstimationSettings(model="grouplet-fast"),
)
NEAR_REGION = RegionSettings("sphere", (0.0, 0.0, 0.0), (0.5, 0.5, 0.5))
FAR_REGION = dataclasses.replace(NEAR_REGION, centre=tuple(UTM.tolist()))


def moved(frame, by=UTM):
    pose = frame.T_world_camera.copy()
    pose[:3, 3] += by
    return dataclasses.replace(frame, T_world_camera=pose)


def scanned(settings, by):
    pipeline = Pipeline(settings)
    for frame in orbit_frames(8):
        pipeline.fuse(moved(frame, by))
    return pipeline


@pytest.fixture(scope="module", params=["scene", "region"])
def pair(request):
    """The same scan at the origin and in UTM."""
    near, far = (NEAR_REGION, FAR_REGION) if request.param == "region" else (RegionSettings(),) * 2
    return (
        scanned(dataclasses.replace(SETTINGS, region=near), np.zeros(3)),
        scanned(dataclasses.replace(SETTINGS, region=far), UTM),
    )


def test_the_surface_is_as_large_as_at_the_origin(pair):
    near, far = pair
    assert near.scan.origin.tolist() == [0.0, 0.0, 0.0]
    assert far.scan.voxel_count == pytest.approx(near.scan.voxel_count, rel=0.03)
    assert far.scan.observation_count == pytest.approx(near.scan.observation_count, rel=0.03)
    assert far.scan.view_count == near.scan.view_count


def test_points_lie_where_they_are_to_a_fraction_of_a_voxel(pair):
    near, far = pair
    away = far.snapshot().surface.world_positions - UTM
    assert np.abs(np.linalg.norm(away, axis=1) - OBJECT.radius).max() < 0.004
    at_origin = near.snapshot().surface.world_positions
    assert at_origin.dtype == np.float32
    assert np.median(np.linalg.norm(away, axis=1)) == pytest.approx(
        np.median(np.linalg.norm(at_origin, axis=1)), abs=1e-4
    )


def test_the_estimate_is_nearly_that_at_the_origin(pair):
    near, far = (one.estimate(one.snapshot()) for one in pair)
    np.testing.assert_allclose(far.rho_d, near.rho_d, atol=0.02)
    assert far.status is near.status


def test_materials_and_their_points_are_in_the_users_frame(pair, tmp_path):
    _, far = pair
    snapshot = far.snapshot()
    found = far.materials(snapshot)
    centre = np.array(found.materials[0].centroid)
    assert np.linalg.norm(centre - UTM) < OBJECT.radius
    assert snapshot.middle is None or found.near(snapshot.middle) is not None
    export_materials(found, tmp_path / "materials.ply")
    written = PlyData.read(tmp_path / "materials.ply")["vertex"]
    assert [str(one.val_dtype) for one in written.properties[:4]] == ["f8", "f8", "f8", "f4"]
    places = np.stack([written[axis] for axis in "xyz"], axis=1) - UTM
    assert np.abs(np.linalg.norm(places, axis=1) - OBJECT.radius).max() < 0.004


def test_a_saved_scan_keeps_its_origin_and_goes_on(pair, tmp_path):
    _, far = pair
    far.save(tmp_path / "scan")
    other = Pipeline(SETTINGS)
    other.load(tmp_path / "scan")
    assert other.scan.origin.tolist() == far.scan.origin.tolist()
    np.testing.assert_array_equal(
        other.snapshot().surface.world_positions, far.snapshot().surface.world_positions
    )
    count = other.scan.voxel_count
    other.restart_clock()
    other.fuse(moved(orbit_frames(9)[4]))
    assert other.scan.voxel_count == pytest.approx(count, rel=0.1)


def test_a_reset_begins_where_the_camera_is_then():
    pipeline = scanned(SETTINGS, UTM)
    pipeline.reset()
    pipeline.fuse(orbit_frames(1)[0])
    assert not pipeline.scan.origin.any()
    assert pipeline.scan.voxel_count > 100
