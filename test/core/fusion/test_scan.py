# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan of an analytic sphere scene reproduces what was put in."""

import copy
import dataclasses

import numpy as np
import pytest

from reflest_core.fusion.observations.views import ViewTable
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import (
    BACKGROUND,
    OBJECT,
    Sphere,
    colour_of,
    look_at,
    orbit,
    orbit_frames,
    render,
)
from test.core.fusion.scan_state import (
    assert_no_ghosts,
    assert_same_arrays,
    assert_same_surface,
    state_of,
)

VOXEL = 0.005
SETTINGS = FusionSettings(voxel_size=VOXEL, max_depth=1.0)
OCCLUDER = Sphere((0.0, 0.22, 0.02), 0.05)
SCENE = (OBJECT, OCCLUDER)


def scan_of(frames, settings=SETTINGS, region=None):
    scan = Scan(settings, region or RegionSettings())
    return scan, [scan.fuse(frame) for frame in frames]


@pytest.fixture(scope="module")
def scene_scan():
    return scan_of(orbit_frames(24, SCENE))


def owner_of(positions):
    """Index of the sphere that each (N, 3) position lies on."""
    gaps = [abs(np.linalg.norm(positions - s.centre, axis=1) - s.radius) for s in SCENE]
    return np.argmin(gaps, axis=0)


def clearance(positions, camera_centres, sphere):
    """Metres between a sphere and the segments from positions to camera centres, both (N, 3)."""
    along = camera_centres - positions
    to_sphere = np.asarray(sphere.centre) - positions
    share = np.sum(along * to_sphere, axis=1) / np.sum(along**2, axis=1)
    nearest = positions + np.clip(share, 0.0, 1.0)[:, None] * along
    return np.linalg.norm(nearest - sphere.centre, axis=1) - sphere.radius


def test_positions_within_half_a_voxel_and_normals_within_two_degrees(scene_scan):
    surface = scene_scan[0].snapshot()
    owner = owner_of(surface.positions)
    for index, sphere in enumerate(SCENE):
        seen_often = (owner == index) & (surface.observation_counts >= 3)
        outward = surface.positions[seen_often] - np.float32(sphere.centre)
        radii = np.linalg.norm(outward, axis=1)
        assert len(radii) > 500
        assert np.abs(radii - sphere.radius).max() < 0.5 * VOXEL
        cosine = np.sum(outward / radii[:, None] * surface.normals[seen_often], axis=1)
        angles = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        assert np.percentile(angles, 99) < 2.0
        assert np.median(angles) < 0.5


def test_every_observation_has_the_colour_of_its_surface_in_its_view(scene_scan):
    surface = scene_scan[0].snapshot()
    owner = np.repeat(owner_of(surface.positions), surface.observation_counts)
    expected = np.array([[colour_of(v, s) for s in range(2)] for v in range(24)])
    np.testing.assert_array_equal(surface.colours, expected[surface.view_indices, owner])


def test_views_that_see_are_present_and_occluded_ones_absent(scene_scan):
    surface = scene_scan[0].snapshot()
    owner = owner_of(surface.positions)
    present = np.zeros((surface.voxel_count, 24), bool)
    voxel_of = np.repeat(np.arange(surface.voxel_count), surface.observation_counts)
    present[voxel_of, surface.view_indices] = True
    occluded_pairs = clear_pairs = 0
    for view in range(24):
        centres = np.broadcast_to(surface.view_centres[view], surface.positions.shape)
        to_camera = centres - surface.positions
        cosine = np.sum(to_camera * surface.normals, axis=1) / np.linalg.norm(to_camera, axis=1)
        gap = np.where(
            owner == 0,
            clearance(surface.positions, centres, OCCLUDER),
            clearance(surface.positions, centres, OBJECT),
        )
        occluded = (gap < 0.0) | (cosine < 0.0)
        clear = (owner == 0) & (gap > 0.03) & (cosine > np.cos(np.radians(45.0)))
        assert not present[occluded, view].any()
        assert present[clear, view].mean() > 0.98
        occluded_pairs += np.sum((gap < 0.0) & (cosine > 0.3))
        clear_pairs += clear.sum()
    assert occluded_pairs > 500
    assert clear_pairs > 10_000


def test_view_directions_point_at_the_cameras(scene_scan):
    scan, _ = scene_scan
    surface = scan.snapshot()
    np.testing.assert_allclose(surface.view_centres, [orbit(n, 24) for n in range(24)], rtol=1e-6)
    assert (scan.voxel_count, scan.view_count) == (surface.voxel_count, 24)
    assert scan.observation_count == len(surface.colours)


def test_foreground_and_background_colours(scene_scan):
    _, fused = scan_of(orbit_frames(3))
    for n, frame in enumerate(fused):
        np.testing.assert_array_equal(frame.foreground, colour_of(n, 0))
        np.testing.assert_array_equal(frame.background, BACKGROUND)
    surface = scene_scan[0].snapshot()
    np.testing.assert_array_equal(surface.view_background, np.tile(BACKGROUND, (24, 1)))
    two_colours = np.array([[colour_of(n, 0), colour_of(n, 1)] for n in range(24)])
    assert np.all(surface.view_foreground >= two_colours.min(axis=1))
    assert np.all(surface.view_foreground <= two_colours.max(axis=1))


def test_only_the_region_is_observed():
    region = RegionSettings("sphere", OBJECT.centre, (0.25, 0.25, 0.25))
    scan, _ = scan_of(orbit_frames(8, SCENE), region=region)
    surface = scan.snapshot()
    assert surface.voxel_count > 1000
    assert np.all(owner_of(surface.positions) == 0)


def test_same_place_twice_adds_no_view():
    T = look_at(orbit(0, 24))
    scan, fused = scan_of([render(SCENE, T, 0), render(SCENE, T, 1)])
    assert [frame.is_new_view for frame in fused] == [True, False]
    assert fused[1].view == 0
    assert scan.view_count == 1
    assert fused[1].observations_kept < 0.02 * fused[0].observations_kept
    assert set(scan.snapshot().view_indices) == {0}


def test_redundant_frame_fills_in_what_the_stored_view_missed():
    T = look_at(orbit(0, 24))
    holed = render(SCENE, T, 0)
    holed.depth[55:65, 75:85] = 0.0
    scan, fused = scan_of([holed, render(SCENE, T, 0, stamp_ns=10**9)])
    assert fused[1].is_new_view is False
    assert fused[1].observations_kept > 20
    whole, _ = scan_of([render(SCENE, T, 0)])
    assert scan.observation_count == pytest.approx(whole.observation_count, rel=0.02)


def test_turning_on_the_spot_to_other_surface_is_a_new_view():
    spot = (0.5, 0.1, 0.0)
    apart = (OBJECT, Sphere((0.2, 0.9, 0.0), 0.1))
    frames = [render(apart, look_at(spot, s.centre), n) for n, s in enumerate(apart)]
    scan, fused = scan_of(frames)
    assert [frame.is_new_view for frame in fused] == [True, True]
    assert scan.view_count == 2


def test_oldest_view_gives_way_with_its_observations():
    scan = Scan(SETTINGS, RegionSettings())
    scan.views = ViewTable(5)
    for frame in orbit_frames(12):
        scan.fuse(frame)
    surface = scan.snapshot()
    frame_of_view = scan.views.stamps // 33_000_000 - 1
    assert sorted(frame_of_view) == [7, 8, 9, 10, 11]
    expected = np.array([colour_of(n, 0) for n in frame_of_view])
    np.testing.assert_array_equal(surface.colours, expected[surface.view_indices])


def test_observations_follow_a_surface_that_moves_to_other_voxels():
    T = look_at((0.5, 0.0, 0.0))
    scan, first = scan_of([render([OBJECT], T, 0)])
    # Half-way between the two, 3 mm nearer, the surface lies in the next voxel over.
    beside = look_at((0.49, 0.1, 0.0))
    scan.fuse(render([Sphere((0.006, 0.0, 0.0), 0.1)], beside, 1))
    surface = scan.snapshot()
    assert_no_ghosts(scan)
    from_first_view = np.sum(surface.view_indices == 0)
    assert from_first_view > 0.85 * first[0].observations_kept
    front = surface.positions[surface.positions[:, 0] > 0.09]
    assert np.median(np.linalg.norm(front, axis=1)) > 0.102


def noisy(frame, rng):
    noise = rng.normal(0.0, 0.002, frame.depth.shape) * (frame.depth > 0.0)
    return dataclasses.replace(frame, depth=(frame.depth + noise).astype(np.float32))


def test_noise_loses_few_observations_and_leaves_no_ghosts():
    rng = np.random.default_rng(0)
    exact = [
        render([OBJECT], look_at(orbit(n // 3, 24)), n // 3, stamp_ns=n + 1) for n in range(72)
    ]
    clean, _ = scan_of(exact)
    rough, _ = scan_of([noisy(frame, rng) for frame in exact])
    assert rough.voxel_count < 1.3 * clean.voxel_count
    assert_no_ghosts(rough)
    per_voxel = [s.observation_count / s.voxel_count for s in (rough, clean)]
    assert per_voxel[0] > 0.8 * per_voxel[1]
    radii = np.linalg.norm(rough.snapshot().positions, axis=1)
    assert np.percentile(np.abs(radii - OBJECT.radius), 99) < 0.5 * VOXEL


def test_two_runs_are_bit_identical(scene_scan):
    again, _ = scan_of(orbit_frames(24, SCENE))
    assert_same_arrays(state_of(scene_scan[0]), state_of(again))


def test_snapshot_is_a_copy():
    frames = orbit_frames(6)
    scan, _ = scan_of(frames[:3])
    before = scan.snapshot()
    kept = copy.deepcopy(before)
    for frame in frames[3:]:
        scan.fuse(frame)
    assert_same_surface(before, kept)


def test_reset_really_empties():
    frames = orbit_frames(4)
    scan, _ = scan_of(frames)
    scan.reset()
    assert (scan.voxel_count, scan.observation_count, scan.view_count) == (0, 0, 0)
    assert scan.volume.count == 0
    assert scan.snapshot().voxel_count == 0
    for frame in frames:
        scan.fuse(frame)
    assert_same_arrays(state_of(scan), state_of(scan_of(frames)[0]))
