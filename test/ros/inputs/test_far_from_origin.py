# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A node whose poses are in UTM: topics and services speak of the user's frame."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from geometry_msgs.msg import Point, Vector3
from sensor_msgs.msg import PointCloud2, PointField
from sphere_messages import messages_of
from sphere_scene import CENTRE, PERIOD_NS, RADIUS, views
from visualization_msgs.msg import MarkerArray

from reflest_ros.msg import MaterialMap
from reflest_ros.outputs.material_message import POINT
from reflest_ros.outputs.point_cloud import far_points
from reflest_ros.srv import Estimate, MaterialAt, SetRegion
from reflest_ros.viewer.received_scan import received_scan

UTM = np.array([500_123.0, 4_600_321.0, 212.0])
PLACE = UTM + CENTRE
UP = (0.0, 0.0, 1.0)
MARKERS = "material_markers", "markers"


@pytest.fixture(scope="module")
def shown(node, peer):
    """What the topics showed of the ball in UTM; the last of each list is the newest."""
    kinds = {
        "materials": MaterialMap,
        "material_cloud": PointCloud2,
        "material_markers": MarkerArray,
        "voxels": PointCloud2,
        "markers": MarkerArray,
    }
    received = {name: peer.listen(kind, f"/reflectance/{name}") for name, kind in kinds.items()}
    x, y, z = PLACE.tolist()
    edge = Vector3(x=0.35, y=0.35, z=0.35)
    centre = Point(x=x, y=y, z=z)
    region = peer.call(SetRegion, "set_region", shape=2, centre=centre, size=edge)
    assert region.success, region.message
    known = list(views(8))
    for index, view in enumerate(known):
        pose = view.T_world_camera.copy()
        pose[:3, 3] += UTM
        stamp_ns = known[0].stamp_ns + index * PERIOD_NS
        moved = dataclasses.replace(view, T_world_camera=pose, stamp_ns=stamp_ns)
        for topic, message in messages_of(moved):
            peer.publish(topic, message)
    peer.wait_for_count("frames fused", 8)
    assert peer.call(Estimate, "estimate").success
    peer.wait_until(
        lambda: (
            all(received.values())
            and received["materials"][-1].materials
            and received["material_cloud"][-1].width
            and received["voxels"][-1].width
            and all(any(m.text for m in received[name][-1].markers) for name in MARKERS)
        ),
        "no materials came",
    )
    return received


def test_the_cloud_has_double_precision_where_the_ball_is(shown):
    cloud = shown["material_cloud"][-1]
    assert [one.datatype for one in cloud.fields[:3]] == [PointField.FLOAT64] * 3
    points = np.frombuffer(bytes(cloud.data), far_points(POINT))
    away = np.stack([points[axis] for axis in "xyz"], axis=1) - PLACE
    lengths = np.linalg.norm(away, axis=1)
    on_ball = away[:, 2] > -0.5 * RADIUS
    assert on_ball.sum() > 100
    assert np.quantile(np.abs(lengths[on_ball] - RADIUS), 0.95) < 0.005
    assert shown["voxels"][-1].fields[0].datatype == PointField.FLOAT64


def test_texts_stand_at_the_ball(shown):
    for name in MARKERS:
        texts = [m for m in shown[name][-1].markers if m.text]
        for marker in texts:
            at = marker.pose.position
            assert np.linalg.norm(np.array([at.x, at.y, at.z]) - PLACE) < 0.5


def test_a_point_in_utm_and_a_pixel_have_their_material(shown, peer):
    x, y, z = (PLACE + np.array([0.0, 0.0, RADIUS])).tolist()
    at_point = peer.call(MaterialAt, "material_at", kind=0, point=Point(x=x, y=y, z=z))
    assert at_point.success, at_point.message
    assert abs(at_point.position.z - z) < 0.02
    under = peer.call(MaterialAt, "material_at", kind=1, u=80.0, v=60.0)
    assert under.success, under.message
    found = np.array([under.position.x, under.position.y, under.position.z])
    assert np.linalg.norm(found - PLACE) < 0.2


def test_the_viewer_shows_it_near_its_own_origin(shown):
    scan = received_scan(shown["materials"][-1], shown["material_cloud"][-1], None, UP)
    assert np.abs(scan.vertices).max() < 200.0
    world = scan.found.surface.world_positions
    assert np.linalg.norm(world.mean(axis=0) - PLACE) < 0.2
