# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The viewer's reading of messages: damaged ones are named, and the last good picture stays."""

from __future__ import annotations

import array

import numpy as np
import pytest
import rclpy
from sensor_msgs.msg import Image

from reflest_core.export.errors import ExportError
from reflest_core.viewer.source import ViewerError
from reflest_ros.inputs.core_messages import ns_to_stamp
from reflest_ros.msg import Material, MaterialMap
from reflest_ros.outputs.material_message import POINT
from reflest_ros.outputs.point_cloud import point_cloud
from reflest_ros.viewer.live_source import LiveSource
from reflest_ros.viewer.received_scan import received_light, received_scan

UP = (0.0, 0.0, 1.0)
STAMP_NS = 5_000_000_000


def ball(count=500, **changes):
    """The cloud of a ball's surface; ``changes`` are values of fields."""
    points = np.zeros(count, POINT)
    directions = np.random.default_rng(0).normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for axis, name in enumerate("xyz"):
        points[name] = 0.05 * directions[:, axis]
        points[f"normal_{name}"] = directions[:, axis]
    points["material_id"] = 1
    for name, value in changes.items():
        points[name][3 if np.isscalar(value) else slice(None)] = value
    return point_cloud(points, "map", STAMP_NS)


def cut():
    cloud = ball()
    cloud.data = cloud.data[:-3]
    return cloud


def one_material(status=0):
    found = MaterialMap(materials=[Material(id=1)])
    found.header.stamp = ns_to_stamp(STAMP_NS)
    found.materials[0].estimate.status = status
    return found


def light(height=4, width=8, count=96, value=0.5):
    image = Image(height=height, width=width)
    image.header.stamp = ns_to_stamp(STAMP_NS)
    image.data = array.array("B", np.full(count, value, np.float32).tobytes())
    return image


@pytest.mark.parametrize(
    ("cloud", "sentence"),
    [
        (cut(), r"holds \d+ of \d+ bytes: it was damaged"),
        (ball(x=np.nan), "not finite"),
        (ball(y=1e30), "not finite, or farther"),
        (ball(normal_z=np.nan), "not finite"),
        (ball(x=[0.0], y=[0.0], z=[0.0]), "are no surface"),
        (ball(1, x=[0.0]), "the 1 points"),
    ],
    ids=["cut", "nan", "far", "normal", "one place", "one point"],
)
def test_a_bad_cloud_is_named(cloud, sentence):
    with pytest.raises(ViewerError, match=sentence):
        received_scan(one_material(), cloud, None, UP)


def test_two_points_are_no_surface():
    with pytest.raises(ExportError, match="2 voxels make no surface"):
        received_scan(one_material(), ball(2), None, UP)


def test_an_unknown_status_is_named():
    with pytest.raises(ViewerError, match="200 is not a valid"):
        received_scan(one_material(200), ball(), None, UP)


@pytest.mark.parametrize(
    ("image", "sentence"),
    [
        (light(count=10), "environment holds 40 bytes where 8 x 4 pixels have 384"),
        (light(0, 0, 0), "holds 0 bytes where 0 x 0"),
        (light(value=np.nan), "not finite"),
    ],
)
def test_a_bad_light_is_named(image, sentence):
    with pytest.raises(ViewerError, match=sentence):
        received_light(image, None, UP)


def test_a_coverage_of_a_wrong_size_is_named():
    coverage = Image(height=4, width=8, data=array.array("B", bytes(3)))
    with pytest.raises(ViewerError, match="environment/coverage holds 3 bytes"):
        received_light(light(), coverage, UP)


@pytest.fixture
def source(domain_id):
    """A source whose node receives nothing by itself."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain_id)
    node = rclpy.create_node("viewer_under_test", context=context)
    yield LiveSource(node, "reflest", UP)
    node.destroy_node()
    context.try_shutdown()


def test_bad_messages_are_warned_of_once_and_the_last_good_picture_stays(source, capfd):
    source._take_materials(one_material())
    source._take_cloud(ball())
    good = source.state().scan
    assert good is not None
    source._take_radiance(light(count=10))
    for _ in range(3):
        source._free_at = 0.0
        source._take_cloud(cut())
    assert source.state().scan is good
    assert "damaged" in source.state().progress
    logged = capfd.readouterr().err
    assert logged.count("reflectance/material_cloud holds") == 1
    assert logged.count("reflectance/environment holds") == 1
    source._free_at = 0.0
    source._take_cloud(ball())
    assert source.state().scan is not good
    assert "1 material" in source.state().progress
