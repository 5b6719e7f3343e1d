# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Text and cameras as markers."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from view_input import estimate, keyframe, looking_down
from visualization_msgs.msg import Marker

from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.scan_memory import ScanMemory
from reflest_core.fusion.frames.region import Region, RegionShape
from reflest_core.fusion.settings import RegionSettings
from reflest_ros.outputs.markers import camera_pyramid, estimate_text, marker_message
from reflest_ros.outputs.view_settings import MarkerSettings

UP = np.array([0.0, 0.0, 1.0])


def markers(shown=None, material=None, poses=(), settings=None, region=None):
    shown = keyframe() if shown is None else shown
    message = marker_message(
        shown, material, list(poses), settings or MarkerSettings(), region or RegionSettings(), UP
    )
    return {marker.ns: marker for marker in message.markers}


def test_the_text_stands_above_the_object_in_the_world_frame():
    text = markers(material=estimate())["values"]
    assert text.type == Marker.TEXT_VIEW_FACING
    assert text.header.frame_id == "map"
    # Five lines, centred on the point, clear the plane at z = 0.
    assert text.pose.position.z > 2.5 * text.scale.z
    assert abs(text.pose.position.x) < 0.01
    assert 0.005 <= text.scale.z <= 0.05
    assert text.color.a == 1
    assert "rho_s  0.040" in text.text


def test_the_text_gives_values_and_confidence():
    lines = estimate_text(estimate()).splitlines()
    assert lines[0] == "rho_d  0.100 0.200 0.300"
    assert lines[2] == "alpha  0.150 ± 0.010"
    assert lines[3] == "40% of directions, 300 views"
    assert lines[4] == "LOW_COVERAGE: move"
    assert len(estimate_text(estimate(status=EstimateStatus.OK)).splitlines()) == 4
    two = estimate_text(estimate(status_text="move; show the room"))
    assert two.splitlines()[4:] == ["LOW_COVERAGE: move", "show the room"]


def test_a_doubtful_estimate_has_another_colour():
    colours = [
        markers(material=material)["values"].color
        for material in (estimate(), None, estimate(status=EstimateStatus.OK))
    ]
    assert colours[0] == colours[1] != colours[2]


def test_without_an_estimate_the_text_says_so():
    assert "no estimate yet" in markers()["values"].text


def test_every_keyframe_is_a_pyramid():
    poses = [looking_down(1.0), looking_down(2.0), looking_down(3.0)]
    cameras = markers(poses=poses)["keyframes"]
    assert cameras.type == Marker.LINE_LIST
    assert len(cameras.points) == len(cameras.colors) == 3 * 16
    assert [cameras.points[16 * n].z for n in range(3)] == [1.0, 2.0, 3.0]
    assert cameras.colors[0] != cameras.colors[-1]


def test_only_the_newest_keyframes_are_drawn():
    poses = [looking_down(float(height)) for height in range(10)]
    cameras = markers(poses=poses, settings=MarkerSettings(max_keyframes=2))["keyframes"]
    assert sorted({point.z for point in cameras.points if point.z in range(10)}) == [8.0, 9.0]


@pytest.mark.parametrize("most", [0, 5])
def test_nothing_to_draw_deletes_what_was_drawn(most):
    poses = [looking_down()] if most == 0 else []
    cameras = markers(poses=poses, settings=MarkerSettings(max_keyframes=most))["keyframes"]
    assert cameras.action == Marker.DELETE
    assert markers(keyframe(voxels=0))["values"].action == Marker.DELETE


def test_the_pyramid_opens_along_the_optical_axis():
    pose = np.eye(4)
    # The camera looks along world x: z to x, x to -y, y to -z.
    pose[:3, :3] = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]
    pose[:3, 3] = [1, 2, 3]
    tip, *base = camera_pyramid(pose, 0.5)
    np.testing.assert_allclose(tip, [1, 2, 3])
    np.testing.assert_allclose(np.mean(base, axis=0), [1.5, 2, 3])


@pytest.mark.parametrize(
    ("shape", "kind", "edges"),
    [("box", Marker.CUBE, (0.1, 0.2, 0.3)), ("sphere", Marker.SPHERE, (0.1, 0.1, 0.1))],
)
def test_the_region_of_interest_is_a_glass_body(shape, kind, edges):
    region = RegionSettings(shape, (1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    body = markers(region=region)["region"]
    assert body.type == kind
    assert (body.scale.x, body.scale.y, body.scale.z) == edges
    assert (body.pose.position.x, body.pose.position.y, body.pose.position.z) == (1, 2, 3)
    assert 0 < body.color.a < 0.3


def test_without_a_region_circles_show_the_work_radius():
    assert markers()["region"].action == Marker.DELETE
    assert markers()["work_radius"].action == Marker.DELETE
    bounds = Region(RegionShape.SPHERE, np.array([1.0, 2.0, 3.0]), np.full(3, 0.5))
    shown = dataclasses.replace(keyframe(), bounds=bounds, memory=ScanMemory())
    circles = markers(shown)["work_radius"]
    places = np.array([[point.x, point.y, point.z] for point in circles.points])
    assert len(places) % 2 == 0
    np.testing.assert_allclose(np.linalg.norm(places - bounds.centre, axis=1), 0.5)
    in_region = dataclasses.replace(shown, memory=None)
    assert markers(in_region)["work_radius"].action == Marker.DELETE
