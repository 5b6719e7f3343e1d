# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import dataclasses

import numpy as np

from reflest_core.fusion.frames.foreground import classify_pixels, foreground_background_means
from reflest_core.fusion.frames.region import Region
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import OBJECT, Sphere, look_at, orbit, render

SETTINGS = FusionSettings(max_depth=0.8)
NO_REGION = Region.from_settings(RegionSettings())
AROUND_OBJECT = Region.from_settings(RegionSettings("box", (0.0, 0.0, 0.0), (0.3, 0.3, 0.3)))


def frame_of(spheres=(OBJECT,), **options):
    return render(spheres, look_at(orbit(2, 24)), 0, **options)


def test_without_mask_and_region_it_is_depth_inside_max_depth():
    frame = frame_of(background_depth=1.5)
    pixels = classify_pixels(frame, NO_REGION, SETTINGS)
    np.testing.assert_array_equal(pixels.foreground, frame.depth < 0.8)


def test_region_takes_back_projected_points_in_the_world_frame():
    beside = Sphere((0.0, 0.0, 0.22), 0.05)
    frame = frame_of([OBJECT, beside], background_depth=0.7)
    pixels = classify_pixels(frame, AROUND_OBJECT, SETTINGS)
    is_object = np.all(frame.rgb == frame_of().rgb, axis=-1) & (frame.depth < 0.69)
    np.testing.assert_array_equal(pixels.foreground, is_object)


def test_mask_comes_before_the_region():
    frame = frame_of()
    mask = np.zeros(frame.depth.shape, bool)
    mask[:40] = True
    pixels = classify_pixels(dataclasses.replace(frame, mask=mask), AROUND_OBJECT, SETTINGS)
    np.testing.assert_array_equal(pixels.foreground, mask)
    assert pixels.surface.any()
    assert not pixels.surface[40:].any()


def test_surface_is_foreground_clear_of_edges():
    frame = frame_of(background_depth=0.9)
    pixels = classify_pixels(frame, AROUND_OBJECT, SETTINGS)
    assert np.all(pixels.foreground[pixels.surface])
    columns = np.flatnonzero(pixels.foreground[60])
    inner = np.flatnonzero(pixels.surface[60])
    assert inner[0] - columns[0] >= SETTINGS.depth_edge_margin
    assert columns[-1] - inner[-1] >= SETTINGS.depth_edge_margin


def test_unusable_depth_values_are_unknown():
    frame = frame_of()
    frame.depth[50, 70:74] = [np.nan, np.inf, -np.inf, -1.0]
    pixels = classify_pixels(frame, NO_REGION, SETTINGS)
    np.testing.assert_array_equal(pixels.depth[50, 70:74], 0.0)
    assert np.isfinite(pixels.depth).all()
    assert not pixels.foreground[50, 70:74].any()


def test_free_depth_is_held_back_near_a_silhouette():
    frame = frame_of(background_depth=0.9)
    pixels = classify_pixels(frame, NO_REGION, SETTINGS)
    edge = np.flatnonzero(frame.depth[60] < 0.8)[0]
    assert pixels.free_depth[60, edge - 3] < 0.6
    assert pixels.free_depth[60, 2] == np.float32(0.9)


def test_means_of_known_pixels():
    rgb = np.zeros((2, 3, 3), np.uint8)
    rgb[0] = [[10, 20, 30], [20, 40, 60], [255, 255, 255]]
    rgb[1] = [[0, 0, 0], [1, 2, 3], [2, 4, 6]]
    foreground = np.array([[True, True, False], [False, False, False]])
    F, B = foreground_background_means(rgb, foreground)
    np.testing.assert_array_equal(F, np.float32([15, 30, 45]))
    np.testing.assert_allclose(B, [258 / 4, 261 / 4, 264 / 4], rtol=1e-6)
    assert F.dtype == B.dtype == np.float32


def test_the_mean_of_no_pixel_is_nan():
    rgb = np.full((4, 4, 3), 7, np.uint8)
    F, B = foreground_background_means(rgb, np.ones((4, 4), bool))
    np.testing.assert_array_equal(F, [7, 7, 7])
    assert np.isnan(B).all()
    F, B = foreground_background_means(rgb, np.zeros((4, 4), bool))
    assert np.isnan(F).all()
    np.testing.assert_array_equal(B, [7, 7, 7])


def test_means_of_a_large_bright_image_do_not_overflow():
    rgb = np.full((480, 640, 3), 255, np.uint8)
    F, _ = foreground_background_means(rgb, np.ones((480, 640), bool))
    np.testing.assert_array_equal(F, [255, 255, 255])
