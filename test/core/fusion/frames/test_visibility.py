# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Each criterion by which a view truly sees a voxel."""

import numpy as np
import pytest

from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames.depth_edges import depth_tolerance
from reflest_core.fusion.frames.foreground import classify_pixels
from reflest_core.fusion.frames.region import Region
from reflest_core.fusion.frames.visibility import visible_voxels
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import SMALL_CAMERA

SETTINGS = FusionSettings(max_depth=2.0, max_grazing_angle=75.0)
TOWARDS_CAMERA = (0.0, 0.0, -1.0)


def wall(depth=1.0, mask=None):
    """A camera at the origin that looks along z at a wall; every pixel has its own colour."""
    v, u = np.mgrid[: SMALL_CAMERA.height, : SMALL_CAMERA.width]
    rgb = np.stack([u, v, u + v], -1).astype(np.uint8)
    image = np.full(u.shape, depth, np.float32)
    return Frame(1, rgb, image, np.eye(4), SMALL_CAMERA, mask)


def point_at(u, v, z):
    camera = SMALL_CAMERA
    return np.float32([(u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z])


def sees(frame, point, normal=TOWARDS_CAMERA, region=None, settings=SETTINGS):
    region = Region.from_settings(region or RegionSettings())
    pixels = classify_pixels(frame, region, settings)
    normal = np.float32([normal]) / np.linalg.norm(normal)
    seen, colours = visible_voxels(
        np.float32([point]), normal.astype(np.float32), frame, pixels, settings
    )
    assert len(seen) == len(colours)
    return colours[0].tolist() if len(seen) else None


@pytest.mark.parametrize("uv", [(40.0, 30.0), (40.4, 29.6), (39.6, 30.4)])
def test_colour_is_interpolated(uv):
    assert sees(wall(), point_at(*uv, 1.0)) == [40, 30, 70]


def test_colour_moves_from_pixel_to_pixel_without_a_jump():
    frame = wall()
    frame.rgb[:, 40], frame.rgb[:, 41] = 100, 200
    found = [sees(frame, point_at(u, 30.0, 1.0))[0] for u in np.linspace(40.0, 41.0, 21)]
    assert found == pytest.approx(np.linspace(100, 200, 21), abs=1.0)


def test_colour_is_clipped_beside_a_clipped_pixel_by_channel():
    frame = wall()
    frame.rgb[30, 40], frame.rgb[30, 41] = 100, (255, 252, 100)
    assert sees(frame, point_at(40.25, 30.0, 1.0)) == [255, 138, 100]


@pytest.mark.parametrize("uv", [(-0.6, 30), (159.6, 30), (40, -0.6), (40, 119.6)])
def test_outside_the_image(uv):
    assert sees(wall(), point_at(*uv, 1.0)) is None


@pytest.mark.parametrize(
    ("uv", "colour"), [((-0.4, 30), [0, 30, 30]), ((159.4, 30), [159, 30, 189])]
)
def test_border_pixels_reach_half_a_pixel_out(uv, colour):
    assert sees(wall(), point_at(*uv, 1.0)) == colour


def test_behind_the_camera():
    assert sees(wall(), -point_at(40, 30, 1.0)) is None


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_depth_must_agree(sign):
    tolerance = depth_tolerance(1.0, SETTINGS.voxel_size)
    assert sees(wall(), point_at(40, 30, 1.0 + sign * 0.9 * tolerance)) is not None
    assert sees(wall(), point_at(40, 30, 1.0 + sign * 1.2 * tolerance)) is None


@pytest.mark.parametrize(("degrees", "is_seen"), [(0, True), (74, True), (76, False), (180, False)])
def test_grazing(degrees, is_seen):
    point = point_at(79.5, 59.5, 1.0)
    normal = (np.sin(np.radians(degrees)), 0.0, -np.cos(np.radians(degrees)))
    assert (sees(wall(), point, normal) is not None) == is_seen


def test_depth_edge():
    frame = wall()
    frame.depth[:, 60:] = 1.5
    margin = SETTINGS.depth_edge_margin
    assert sees(frame, point_at(59 - margin, 30, 1.0)) is not None
    assert sees(frame, point_at(60 - margin, 30, 1.0)) is None
    assert sees(frame, point_at(59 + margin, 30, 1.5)) is None
    assert sees(frame, point_at(60 + margin, 30, 1.5)) is not None


def test_border_to_unknown_depth():
    frame = wall()
    frame.depth[:, 60:] = 0.0
    assert sees(frame, point_at(59 - SETTINGS.depth_edge_margin, 30, 1.0)) is not None
    assert sees(frame, point_at(60 - SETTINGS.depth_edge_margin, 30, 1.0)) is None


def test_mask():
    mask = np.zeros((SMALL_CAMERA.height, SMALL_CAMERA.width), bool)
    mask[:, 50:] = True
    assert sees(wall(mask=mask), point_at(50, 30, 1.0)) is not None
    assert sees(wall(mask=mask), point_at(49, 30, 1.0)) is None


def test_region():
    sphere = RegionSettings("sphere", (0.0, 0.0, 1.0), (0.2, 0.0, 0.0))
    assert sees(wall(), (0.09, 0.0, 1.0), region=sphere) is not None
    assert sees(wall(), (0.11, 0.0, 1.0), region=sphere) is None


def test_max_depth():
    assert sees(wall(1.9), point_at(40, 30, 1.9)) is not None
    assert sees(wall(2.1), point_at(40, 30, 2.1)) is None
