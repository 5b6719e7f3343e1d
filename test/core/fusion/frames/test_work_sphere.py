# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Without a region, what lies around the scan's centre is scanned, and the rest is light."""

import dataclasses

import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.fusion.frames.work_sphere import (
    EARLY_FRAMES,
    RADII,
    WorkSphere,
)
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.scan_file import ScanFileError
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import BACKGROUND, look_at, orbit, orbit_frames, render
from test.core.fusion.scan_state import assert_same_arrays, state_of
from test.core.fusion.test_scan_file import rewrite

SETTINGS = FusionSettings(max_depth=3.0)
WALL = 1.8
"""Depth of the wall behind the sphere, metres: nearer than ``max_depth``."""


def scan_of(frames, settings=SETTINGS):
    scan = Scan(settings, RegionSettings())
    for frame in frames:
        scan.fuse(frame)
    return scan


def test_walls_beyond_the_work_radius_are_light_and_not_surface():
    scan = scan_of(orbit_frames(12, background_depth=WALL))
    radii = np.linalg.norm(scan.snapshot().positions, axis=1)
    assert len(radii) > 3000
    assert radii.max() < 0.11
    assert scan.light.seen_share > 0.1
    light = scan.light.observed()
    seen = light.radiance[light.coverage > 0.0]
    assert np.ptp(seen, axis=0).max() < 1e-6


def test_walls_within_the_work_radius_are_surface():
    scan = scan_of(
        orbit_frames(12, background_depth=WALL), dataclasses.replace(SETTINGS, work_radius=5.0)
    )
    assert np.linalg.norm(scan.snapshot().positions, axis=1).max() > 1.0
    assert scan.light.seen_share == 0.0


def test_the_automatic_radius_is_twice_the_distance_and_stays_after_the_early_frames():
    scan = scan_of(orbit_frames(EARLY_FRAMES, background_depth=WALL))
    early = scan.work_sphere
    assert early.frames == EARLY_FRAMES
    assert RADII * 0.4 < early.radius(SETTINGS) < RADII * 0.48
    assert np.linalg.norm(early.centre) < 0.1
    far = render([], look_at(orbit(3, 24, distance=2.0)), 40, background_depth=1.5)
    scan.fuse(far)
    assert scan.work_sphere == early


def test_frames_that_are_refused_do_not_move_it():
    scan = scan_of(orbit_frames(12, background_depth=WALL))
    before = state_of(scan), scan.work_sphere
    wall = render([], look_at(orbit(3, 24)), 12, background_depth=2.5)
    with pytest.raises(FrameRefused, match=r"scan's centre: .*work_radius") as refused:
        scan.fuse(wall)
    assert refused.value.cause is RefusalCause.NO_OVERLAP
    assert_same_arrays(before[0], state_of(scan))
    assert scan.work_sphere == before[1]


def test_a_loaded_scan_goes_on_with_its_sphere(tmp_path):
    scan = scan_of(orbit_frames(4, background_depth=WALL))
    scan.save(tmp_path / "scan")
    loaded = Scan.load(tmp_path / "scan")
    assert loaded.work_sphere == scan.work_sphere
    for frame in orbit_frames(12, background_depth=WALL)[4:]:
        scan.fuse(frame)
        loaded.fuse(frame)
    assert_same_arrays(state_of(scan), state_of(loaded))


@pytest.mark.parametrize(
    "damaged", [{"centre": [0, 0], "distance": 1, "frames": 1}, {"centre": [0, 0, float("inf")]}, 7]
)
def test_a_damaged_sphere_in_a_file_is_refused(damaged, tmp_path):
    scan_of(orbit_frames(2)).save(tmp_path / "scan")
    rewrite(tmp_path / "scan", header={"work_sphere": damaged})
    with pytest.raises(ScanFileError, match="damaged"):
        Scan.load(tmp_path / "scan")


def test_a_mask_is_the_surface_whatever_the_sphere():
    frame = orbit_frames(1, background_depth=WALL)[0]
    mask = np.zeros(frame.depth.shape, bool)
    mask[:40, :40] = True
    scan = scan_of([dataclasses.replace(frame, mask=mask)])
    assert np.linalg.norm(scan.snapshot().positions, axis=1).min() > 0.5


def test_a_frame_without_depth_leaves_it_empty():
    frame = dataclasses.replace(orbit_frames(1)[0], depth=np.zeros((120, 160), np.float32))
    assert WorkSphere().updated(frame, SETTINGS) == WorkSphere()


def test_a_dark_spot_on_the_object_does_not_darken_the_light():
    frames = orbit_frames(6, background_depth=WALL)
    for frame in frames:
        frame.depth[55:66, 75:86] = 0.0
        frame.rgb[55:66, 75:86] = 0
    light = scan_of(frames).light.observed()
    seen = light.radiance[light.coverage > 0.0]
    np.testing.assert_allclose(seen, np.broadcast_to(srgb.LINEAR[BACKGROUND], seen.shape), 1e-5)
