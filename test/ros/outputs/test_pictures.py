# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The renderer of the documentation's pictures puts things where a display would."""

from __future__ import annotations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from view_input import estimate, keyframe

from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.settings import RegionSettings
from reflest_ros.demo.pictures import preview_picture
from reflest_ros.demo.view_scene import Viewpoint, draw_cloud, draw_markers, prepare
from reflest_ros.outputs.markers import marker_message
from reflest_ros.outputs.point_cloud import point_cloud
from reflest_ros.outputs.preview import preview_message
from reflest_ros.outputs.view_settings import MarkerSettings
from reflest_ros.outputs.voxel_cloud import POINT

AHEAD = Viewpoint(np.array([0.0, -2.0, 0.0]), np.zeros(3), 1.0)


def pixels(figure):
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].astype(int)


def picture(*draw):
    figure = Figure(figsize=(2, 2), dpi=100)
    axes = figure.add_axes((0, 0, 1, 1))
    prepare(axes, AHEAD, 1.0)
    for one in draw:
        one(axes)
    return pixels(figure)


def test_right_is_right_up_is_up_and_far_is_small():
    places, distances = AHEAD.project(np.array([[0.2, 0, 0], [0, 0, 0.2], [0.2, 2, 0]]))
    np.testing.assert_allclose(places, [[0.2, 0], [0, 0.2], [0.1, 0]], atol=1e-12)
    np.testing.assert_allclose(distances, [1, 1, 2])


def test_the_nearer_point_hides_the_farther_one():
    points = np.zeros(2, POINT)
    points["y"] = [-0.5, 0.5]
    points["rgb"] = [0xFF0000, 0x0000FF]
    cloud = point_cloud(points, "map", 0)
    image = picture(lambda axes: draw_cloud(axes, cloud, AHEAD, 0.1))
    np.testing.assert_array_equal(image[100, 100], [255, 0, 0])
    np.testing.assert_array_equal(image[10, 10], [0x30] * 3)


def test_markers_are_drawn():
    shown = keyframe()
    markers = marker_message(
        shown,
        estimate(),
        [shown.T_world_camera],
        MarkerSettings(),
        RegionSettings(),
        np.array(ReflestSettings().estimation.up),
    )
    empty = picture()
    drawn = picture(lambda axes: draw_markers(axes, markers, AHEAD))
    assert np.any(empty != drawn)


def test_the_preview_is_shown_pixel_for_pixel():
    message = preview_message(estimate(), 256)
    sent = np.frombuffer(message.data, np.uint8).reshape(256, 256, 3)
    np.testing.assert_array_equal(pixels(preview_picture(estimate())), sent)
