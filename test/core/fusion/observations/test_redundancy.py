# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Frames that show nothing new from a place seen often are skipped, and only they."""

import numpy as np
import pytest

from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import OBJECT, Sphere, look_at, orbit, orbit_frames, render
from test.core.fusion.scan_state import assert_same_arrays, state_of

SETTINGS = FusionSettings(max_depth=1.0, frames_per_view=4)
HERE = look_at(orbit(0, 24))
BACKDROP = Sphere((-1.2, 0.0, 0.0), 0.9)
SCENE = (OBJECT, BACKDROP)
FAR = FusionSettings(max_depth=1.5, frames_per_view=4)


def still(count, spheres=(OBJECT,), T=HERE, first=0):
    return [render(spheres, T, 0, stamp_ns=first + n + 1) for n in range(count)]


def test_a_camera_that_stands_still_is_fused_a_few_times_and_then_skipped():
    scan = Scan(SETTINGS, RegionSettings())
    fused = [scan.fuse(frame) for frame in still(7)]
    assert [f.is_redundant for f in fused] == [False] * 4 + [True] * 3
    assert [f.is_new_view for f in fused] == [True] + [False] * 6
    last = fused[-1]
    assert (last.view, last.blocks_projected, last.voxels_seen, last.observations_kept) == (0,) * 4
    np.testing.assert_array_equal(last.foreground, fused[0].foreground)


def test_a_frame_of_known_surface_brings_its_depth_alone():
    scan = Scan(SETTINGS, RegionSettings())
    first, second, moved = [*still(2), render([OBJECT], look_at(orbit(0.06, 24)), 0, stamp_ns=9)]
    scan.fuse(first)
    before, observations = scan.volume.blocks.weight.sum(dtype=int), scan.observation_count
    for frame in (second, moved):
        fused = scan.fuse(frame)
        assert (fused.view, fused.is_new_view, fused.is_redundant) == (0, False, False)
        assert fused.blocks_changed > 0
        assert (fused.surface_voxels, fused.observations_kept) == (0, 0)
    assert scan.volume.blocks.weight.sum(dtype=int) > 2.5 * before
    assert scan.observation_count == observations


def test_a_redundant_frame_leaves_the_scan_as_it_was_but_for_the_clock():
    scan = Scan(SETTINGS, RegionSettings())
    *frames, another = still(5)
    for frame in frames:
        scan.fuse(frame)
    before = state_of(scan)
    assert scan.fuse(another).is_redundant
    assert scan.last_stamp_ns == another.stamp_ns
    after = state_of(scan)
    del before["numbers"], after["numbers"]
    assert_same_arrays(before, after)


@pytest.mark.parametrize("degrees", [2.5, 10.0, 180.0])
def test_from_elsewhere_it_is_not_redundant(degrees):
    scan = Scan(SETTINGS, RegionSettings())
    for frame in still(5):
        scan.fuse(frame)
    moved = look_at(orbit(degrees / 15.0, 24))
    assert not scan.fuse(render([OBJECT], moved, 0, stamp_ns=99)).is_redundant


def test_turning_to_new_surface_is_not_redundant():
    beside = Sphere((0.0, 0.25, 0.0), 0.1)
    scan = Scan(SETTINGS, RegionSettings())
    for frame in still(5, [OBJECT, beside], look_at(HERE[:3, 3], (0.0, -0.2, 0.0))):
        scan.fuse(frame)
    turned = render([OBJECT, beside], look_at(HERE[:3, 3], (0.0, 0.15, 0.0)), 0, stamp_ns=99)
    assert not scan.fuse(turned).is_redundant


@pytest.mark.parametrize("change", ["comes", "goes"])
def test_a_small_thing_that_comes_or_goes_is_not_redundant(change):
    thing = Sphere((0.0, 0.17, 0.0), 0.045)
    states = [SCENE, (*SCENE, thing)]
    before, after = states if change == "comes" else states[::-1]
    scan = Scan(FAR, RegionSettings())
    fused = [scan.fuse(frame) for frame in still(6, before)]
    assert fused[-1].is_redundant
    assert not scan.fuse(render(after, HERE, 0, stamp_ns=99)).is_redundant


def test_noise_of_a_sensor_does_not_make_a_frame_new():
    rng = np.random.default_rng(0)
    scan = Scan(SETTINGS, RegionSettings())
    for frame in still(20):
        frame.depth[frame.depth > 0] += rng.normal(0.0, 0.0015, (frame.depth > 0).sum())
        fused = scan.fuse(frame)
    assert fused.is_redundant


def test_a_loaded_scan_knows_which_views_are_done(tmp_path):
    scan = Scan(SETTINGS, RegionSettings())
    for frame in still(5):
        scan.fuse(frame)
    scan.save(tmp_path / "still.scan")
    assert Scan.load(tmp_path / "still.scan").fuse(still(1, first=50)[0]).is_redundant


def test_an_orbit_has_no_redundant_frame():
    scan = Scan(SETTINGS, RegionSettings())
    assert not any(scan.fuse(frame).is_redundant for frame in orbit_frames(24))
