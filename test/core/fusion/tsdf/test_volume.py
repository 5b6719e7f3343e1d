# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.spatial import cKDTree

from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames.foreground import classify_pixels
from reflest_core.fusion.frames.region import Region
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.tsdf.volume import BYTES_PER_BLOCK, TsdfVolume
from reflest_core.surface.voxel_key import unpack_key
from test.core.fusion.analytic_scene import (
    OBJECT,
    SMALL_CAMERA,
    Sphere,
    look_at,
    orbit,
    orbit_frames,
    render,
)
from test.core.fusion.open3d_peer import open3d_surface

SETTINGS = FusionSettings(max_depth=1.0)
THREADS = 2
NO_REGION = Region.from_settings(RegionSettings())


def fuse(volume, frames):
    """Fuse frames; return the last update over all blocks and the keys erased on the way."""
    erased = []
    for number, frame in enumerate(frames, start=1):
        pixels = classify_pixels(frame, NO_REGION, SETTINGS)
        near, gone = volume.allocate(frame, pixels, number)
        erased.extend(gone.tolist())
        slots = volume.in_sight(near, frame, SETTINGS.max_depth, number)
        volume.extract(volume.integrate(slots, frame, pixels, number, THREADS), THREADS)
    return volume.extract(np.arange(volume.count), THREADS), erased


@pytest.fixture(scope="module")
def sphere_frames():
    return orbit_frames(24)


@pytest.fixture(scope="module")
def sphere_surface(sphere_frames):
    return fuse(TsdfVolume(0.005, 4.0, 1000), sphere_frames)[0]


def test_zero_level_is_the_sphere(sphere_surface):
    radii = np.linalg.norm(sphere_surface.positions, axis=1)
    assert len(radii) > 4000
    assert np.abs(radii - OBJECT.radius).max() < 0.25 * 0.005
    outward = sphere_surface.positions / radii[:, None]
    angles = np.degrees(np.arccos(np.clip(np.sum(outward * sphere_surface.normals, axis=1), -1, 1)))
    assert np.percentile(angles, 99) < 1.5
    assert np.median(angles) < 0.3


def test_sample_points_lie_at_the_voxel_index_and_feet_in_their_own_cells(sphere_surface):
    samples = np.array([unpack_key(key) for key in sphere_surface.keys]) * 0.005
    assert np.abs(sphere_surface.positions - samples).max() <= 0.75 * 0.005 * 1.001
    assert len(np.unique(sphere_surface.keys)) == len(sphere_surface.keys)


def test_surface_agrees_with_open3d(sphere_frames, sphere_surface):
    peer = open3d_surface(sphere_frames, 0.005, 4.0, 1.0)
    distance, nearest = cKDTree(peer).query(sphere_surface.positions)
    assert np.percentile(distance, 99) < 0.005
    along = np.sum((peer[nearest] - sphere_surface.positions) * sphere_surface.normals, axis=1)
    assert abs(np.median(along)) < 0.1 * 0.005
    assert np.percentile(np.abs(along), 95) < 0.5 * 0.005


def test_surface_that_went_away_is_cleared():
    ghost = Sphere((0.0, 0.0, 0.2), 0.03)
    volume = TsdfVolume(0.005, 4.0, 1000)
    with_ghost, _ = fuse(volume, [render([OBJECT, ghost], look_at(orbit(0, 24)), 0)])
    assert np.any(with_ghost.positions[:, 2] > 0.15)
    views = [render([OBJECT], look_at(orbit(0, 24)), n, background_depth=1.5) for n in range(1, 6)]
    without, _ = fuse(volume, views)
    assert not np.any(without.positions[:, 2] > 0.15)
    assert np.any(without.positions[:, 2] < 0.1)


def test_voxels_that_leave_are_reported_with_where_their_surface_went():
    volume = TsdfVolume(0.005, 4.0, 1000)
    first, _ = fuse(volume, [render([OBJECT], look_at((0.5, 0.0, 0.0)), 0)])
    nearer = Sphere((0.006, 0.0, 0.0), 0.1)
    frame = render([nearer], look_at((0.5, 0.0, 0.0)), 1)
    pixels = classify_pixels(frame, NO_REGION, SETTINGS)
    slots = volume.in_sight(np.empty(0, np.int64), frame, SETTINGS.max_depth, 2)
    change = volume.extract(volume.integrate(slots, frame, pixels, 2, THREADS), THREADS)
    # The mean surface has moved 3 mm towards the camera: more than half a voxel.
    facing = {k: p for k, p in zip(first.keys, first.positions, strict=True) if p[0] > 0.09}
    left = set(change.left.tolist())
    assert len(left & set(facing)) > 0.2 * len(facing)
    handed_on = change.left_to > 0
    assert np.all(np.isin(change.left_to[handed_on], change.keys))
    moved_from = np.array([unpack_key(key) for key in change.left[handed_on]])
    moved_to = np.array([unpack_key(key) for key in change.left_to[handed_on]])
    facing_camera = moved_from[:, 0] > 18
    assert handed_on.mean() > 0.8
    assert np.all(moved_to[facing_camera, 0] - moved_from[facing_camera, 0] == 1)
    assert not left & set(change.keys.tolist())


def test_a_surface_voxel_stays_until_its_foot_point_is_well_outside():
    volume = TsdfVolume(0.005, 4.0, 2000)
    layers, left = [], []
    # Mean depths of 200.4, 200.56 and 200.77 voxels.
    for number, depth in enumerate((1.002, 1.0036, 1.006), start=1):
        image = np.full((120, 160), depth, np.float32)
        frame = Frame(number, np.zeros((120, 160, 3), np.uint8), image, np.eye(4), SMALL_CAMERA)
        pixels = classify_pixels(frame, NO_REGION, FusionSettings(max_depth=2.0))
        near, _ = volume.allocate(frame, pixels, number)
        change = volume.extract(volume.integrate(near, frame, pixels, number, 1), 1)
        layers.append({unpack_key(key)[2] for key in change.keys})
        left.append({unpack_key(key)[2] for key in change.left})
    assert layers == [{200}, {200, 201}, {201}]
    assert left == [set(), set(), {200}]


def test_a_full_volume_erases_the_blocks_unseen_for_longest():
    capacity = 60
    volume = TsdfVolume(0.005, 4.0, capacity)
    reserved = volume.nbytes
    far_apart = [Sphere((0.4 * n, 0.0, 0.0), 0.05) for n in range(4)]
    frames = [
        render([s], look_at((s.centre[0], -0.5, 0.0), s.centre), n) for n, s in enumerate(far_apart)
    ]
    surface, erased = fuse(volume, frames)
    assert volume.count <= capacity
    assert volume.nbytes == reserved <= capacity * BYTES_PER_BLOCK
    x = surface.positions[:, 0]
    assert np.any(x > 1.1)
    assert not np.any(x < 0.2)
    erased_x = np.array([unpack_key(key)[0] for key in erased]) * 0.005
    assert np.any(erased_x < 0.2)
    assert not np.any(erased_x > 1.1)


def test_a_frame_larger_than_the_volume_fills_it():
    volume = TsdfVolume(0.005, 4.0, 20)
    fuse(volume, orbit_frames(3))
    assert volume.count == 20


def test_surface_does_not_depend_on_how_views_are_turned():
    upright = render([OBJECT], look_at((0.5, 0.1, 0.2)), 0)
    a, _ = fuse(TsdfVolume(0.005, 4.0, 1000), [upright])
    roll = np.eye(4)
    roll[:2, :2] = [[0.0, -1.0], [1.0, 0.0]]
    rolled = render([OBJECT], upright.T_world_camera @ roll, 0)
    b, _ = fuse(TsdfVolume(0.005, 4.0, 1000), [rolled])
    shared, in_a, in_b = np.intersect1d(a.keys, b.keys, return_indices=True)
    assert len(shared) > 0.8 * len(a.keys)
    gap = np.linalg.norm(a.positions[in_a] - b.positions[in_b], axis=1)
    assert np.median(gap) < 0.1 * 0.005
