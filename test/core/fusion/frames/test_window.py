# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Looking only where the object can be gives the scan that looking everywhere gives."""

import dataclasses

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from reflest_core.fusion import scan as scan_module
from reflest_core.fusion.frames.foreground import classify_pixels
from reflest_core.fusion.frames.region import Region
from reflest_core.fusion.frames.window import MARGIN, Window, cropped, object_window
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import (
    OBJECT,
    SMALL_CAMERA,
    Sphere,
    look_at,
    orbit,
    orbit_frames,
    render,
)

WHOLE = Window(0, SMALL_CAMERA.height, 0, SMALL_CAMERA.width)
BOX = RegionSettings("box", (0.02, 0.0, 0.01), (0.24, 0.3, 0.2))
SPHERE = RegionSettings("sphere", (0.02, 0.0, 0.01), (0.22, 0.0, 0.0))
SETTINGS = FusionSettings(max_depth=1.0)
SCENE = (OBJECT, Sphere((0.0, 0.22, 0.02), 0.05))


@given(st.integers(0, 23), st.floats(0.25, 1.5), st.sampled_from([BOX, SPHERE]))
def test_it_holds_every_pixel_of_the_region_and_its_margin(n, distance, region):
    region = Region.from_settings(region)
    frame = render([OBJECT], look_at(orbit(n, 24, distance)), 0)
    window = object_window(frame, region)
    pixels = classify_pixels(frame, region, SETTINGS)
    outside = pixels.foreground.copy()
    outside[window.slices] = False
    assert not outside.any()
    if pixels.foreground.any():
        rows, columns = np.nonzero(pixels.foreground)
        assert window.top <= max(rows.min() - MARGIN, 0)
        assert window.bottom >= min(rows.max() + MARGIN + 1, SMALL_CAMERA.height)
        assert window.left <= max(columns.min() - MARGIN, 0)
        assert window.right >= min(columns.max() + MARGIN + 1, SMALL_CAMERA.width)


def test_without_region_it_is_the_image():
    frame = orbit_frames(1)[0]
    assert object_window(frame, Region.from_settings(RegionSettings())) == WHOLE


@pytest.mark.parametrize("camera_at", [(0.03, 0.0, 0.01), (0.0, 0.0, 5.0)])
def test_region_around_or_behind_the_camera(camera_at):
    frame = render([OBJECT], look_at(camera_at, (camera_at[0], 1.0, camera_at[2] + 0.1)), 0)
    assert object_window(frame, Region.from_settings(BOX)) == WHOLE


def test_mask_sets_it():
    frame = orbit_frames(1)[0]
    mask = np.zeros(frame.depth.shape, bool)
    mask[60:70, 50:100] = True
    window = object_window(dataclasses.replace(frame, mask=mask), Region.from_settings(BOX))
    assert window == Window(20, 110, 10, 140)
    empty = dataclasses.replace(frame, mask=np.zeros_like(mask))
    assert object_window(empty, Region.from_settings(BOX)) == WHOLE


def test_cropped_pixels_look_in_the_same_directions():
    frame = orbit_frames(1)[0]
    part = cropped(frame, Window(10, 50, 20, 90))
    assert part.depth.shape == (40, 70) == (part.intrinsics.height, part.intrinsics.width)
    np.testing.assert_array_equal(part.rgb[5, 7], frame.rgb[15, 27])
    ray = np.linalg.solve(frame.intrinsics.matrix, [27.0, 15.0, 1.0])
    np.testing.assert_allclose(part.intrinsics.matrix @ ray, [7.0, 5.0, 1.0], atol=1e-12)
    assert cropped(frame, WHOLE) is frame


def sorted_store(scan):
    """Keys, positions, colours and view ids of the stored voxels in the order of their keys."""
    rows = scan.store.rows
    order = np.argsort(rows.keys[: scan.store.count])
    colours, view_ids = scan.store.observations(order)
    return rows.keys[order], rows.positions[order], colours.astype(int), view_ids.astype(int)


@pytest.mark.parametrize("region", [BOX, SPHERE])
def test_the_scan_is_the_same(monkeypatch, region):
    frames = orbit_frames(12, SCENE, background_depth=1.5)

    def scan_of():
        scan = Scan(SETTINGS, region)
        fused = [scan.fuse(frame) for frame in frames]
        return scan, [(f.foreground.tolist(), f.background.tolist(), f.voxels_seen) for f in fused]

    scan, told = scan_of()
    monkeypatch.setattr(scan_module, "object_window", lambda frame, region: WHOLE)
    other, told_other = scan_of()
    assert told == told_other
    for one, same in zip(sorted_store(scan), sorted_store(other), strict=True):
        np.testing.assert_allclose(one, same, rtol=0.0, atol=2e-5)
