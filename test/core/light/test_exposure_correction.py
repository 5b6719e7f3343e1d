# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Colours of views of different exposure, made comparable."""

import dataclasses

import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.fusion.observations.exposure import MOST_VOXELS, surface_shifts
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.light.exposure_correction import at_one_exposure, means_at_one_exposure
from test.core.fusion.analytic_scene import OBJECT, look_at, orbit, render

VIEWS = 24
SETTINGS = FusionSettings(voxel_size=0.01, max_depth=1.0, memory_budget_mb=64)


def eight_bit(linear):
    return np.rint(srgb.encode(np.asarray(linear, np.float64)) * 255).astype(np.uint8)


def test_the_same_light_at_three_exposures_is_one_colour():
    light = np.array([[0.2, 0.4, 0.1]])
    gains = np.array([1.0, 2.0, 0.8], np.float32)
    seen = np.concatenate([eight_bit(light / gain) for gain in gains.astype(float)])
    corrected = at_one_exposure(seen, gains, np.arange(3, dtype=np.uint16))
    assert np.abs(corrected.astype(int) - eight_bit(light)).max() <= 1
    means = means_at_one_exposure(seen.astype(np.float32), gains)
    assert np.abs(means - eight_bit(light)).max() <= 1.0


def test_one_exposure_changes_nothing():
    colours = np.random.default_rng(0).integers(0, 256, (50, 3)).astype(np.uint8)
    views = np.zeros(50, np.uint16)
    assert at_one_exposure(colours, np.ones(3, np.float32), views) is colours
    means = np.array([[1.5, np.nan, 255.0]], np.float32)
    np.testing.assert_array_equal(means_at_one_exposure(means, np.ones(1, np.float32)), means)


@pytest.mark.parametrize("gain", [0.25, 4.0])
def test_what_is_clipped_stays_a_lower_bound(gain):
    colours = np.array([[255, 254, 0]], np.uint8)
    gains = np.array([gain], np.float32)
    corrected = at_one_exposure(colours, gains, np.zeros(1, np.uint16))
    assert corrected[0, 0] == 255
    assert (corrected[0, 1] == 255) == (gain > 1.0)
    assert corrected[0, 2] == 0
    assert np.isnan(means_at_one_exposure(np.full((1, 3), np.nan, np.float32), gains)).all()


def frames(exposures):
    """A grey sphere before a background whose colours depend on the direction alone."""
    for number, exposure in enumerate(exposures):
        frame = render([OBJECT], look_at(orbit(number, VIEWS)), number)
        v, u = np.mgrid[: frame.depth.shape[0], : frame.depth.shape[1]]
        camera = frame.intrinsics
        rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, v * 0 + 1.0], -1)
        rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True) @ frame.T_world_camera[:3, :3].T
        light = 0.15 + 0.1 * np.sin(6.0 * rays)
        light[frame.depth > 0] = 0.2
        frame.rgb[:] = eight_bit(light * exposure)
        yield frame


def scanned(exposures):
    scan = Scan(SETTINGS, RegionSettings())
    for frame in frames(exposures):
        scan.fuse(frame)
    return scan


def test_a_scan_distinguishes_exposure_from_reflectance(tmp_path):
    exposures = 2.0 ** np.linspace(0.0, -1.5, VIEWS)
    scan = scanned(exposures)
    np.testing.assert_allclose(scan.views.gains[: scan.views.count] * exposures, 1.0, rtol=0.06)
    surface = scan.snapshot()
    colours = srgb.decode(surface.colours / 255.0)
    assert colours.max() < 1.15 * colours.min()
    assert colours.mean() == pytest.approx(0.2, rel=0.05)
    foreground = srgb.decode(surface.view_foreground / 255.0)
    np.testing.assert_allclose(foreground, 0.2, rtol=0.1)

    # What was found is saved, and the next frame goes on from it.
    scan.save(tmp_path / "scan")
    loaded = Scan.load(tmp_path / "scan")
    assert loaded.light.gain == scan.light.gain != 1.0
    np.testing.assert_array_equal(loaded.snapshot().colours, surface.colours)
    scan.reset()
    assert scan.light.gain == 1.0


def test_a_locked_exposure_leaves_the_scan_as_it_is():
    scan = scanned(np.ones(VIEWS))
    assert (scan.views.gains == 1.0).all()
    stored, _ = scan.store.observations(np.arange(scan.store.count))
    np.testing.assert_array_equal(scan.snapshot().colours, stored)


def test_another_exposure_from_the_same_place_is_another_view():
    """Where a frame only fills in what a view missed, its colours must be of that view's gain."""
    for exposure, views in ((1.0, 1), (0.5, 2)):
        scan = Scan(SETTINGS, RegionSettings())
        first, second = frames([1.0, exposure])
        rows, columns = np.nonzero(first.depth)
        hidden = columns < np.quantile(columns, 0.1)
        first.depth[rows[hidden], columns[hidden]] = 0.0
        scan.fuse(first)
        whole = next(iter(frames([exposure])))
        scan.fuse(dataclasses.replace(whole, stamp_ns=second.stamp_ns))
        assert scan.views.count == views
        np.testing.assert_allclose(scan.views.gains[views - 1], 1.0 / exposure, rtol=0.05)


def test_voxels_tell_the_stops_between_a_frame_and_what_was_known_of_them():
    scan = scanned([1.0, 0.5])
    rows = np.flatnonzero(scan.store.rows.counts[: scan.store.count] > 0)
    light = np.full((len(rows), 3), 0.2)
    light[0], light[1] = 1.0, 0.0  # clipped; dark
    shifts = surface_shifts(
        scan.store, scan.views, rows, eight_bit(light / 4.0 + (light == 1.0)), orbit(1, VIEWS)
    )
    assert 20 <= len(shifts) <= MOST_VOXELS
    np.testing.assert_allclose(shifts, 2.0, atol=0.1)
    nothing = np.empty(0, np.int64)
    none = surface_shifts(scan.store, scan.views, nothing, np.empty((0, 3), np.uint8), np.zeros(3))
    assert len(none) == 0
