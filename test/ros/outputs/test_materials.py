# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The materials of a scan on their topics and from the service; the tests share one node."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from geometry_msgs.msg import Point
from rcl_interfaces.msg import ParameterType, ParameterValue
from sensor_msgs.msg import Image, PointCloud2, PointField
from sphere_scene import CENTRE, HEIGHT, WIDTH
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from reflest_ros.msg import BrdfEstimate, MaterialMap
from reflest_ros.outputs.material_message import POINT
from reflest_ros.srv import Estimate, MaterialAt


@pytest.fixture(scope="module")
def shown(feed, peer):
    """What the topics showed after some views; the last of each list is the newest."""
    topics = {
        "materials": MaterialMap,
        "material_cloud": PointCloud2,
        "material_markers": MarkerArray,
        "overlay": Image,
    }
    received = {name: peer.listen(kind, f"/reflectance/{name}") for name, kind in topics.items()}
    for _ in range(8):
        feed.send_good()
    assert peer.call(Estimate, "estimate").success
    peer.wait_until(
        lambda: all(received.values()) and received["materials"][-1].materials,
        "no materials came",
    )
    return received


def test_materials_come_in_falling_order_of_area_with_their_estimates(shown):
    found = shown["materials"][-1]
    assert found.header.frame_id == "world"
    assert found.schema_version == 3
    areas = [material.area for material in found.materials]
    assert areas == sorted(areas, reverse=True)
    for material in found.materials:
        assert material.id > 0
        assert material.estimate.status != BrdfEstimate.STATUS_UNKNOWN
        assert material.estimate.schema_version == 3
        assert material.voxel_count <= found.voxel_count
        assert 0.0 < material.extent.x < 0.4


def test_the_cloud_holds_every_observed_voxel_with_its_material(shown):
    cloud, found = shown["material_cloud"][-1], shown["materials"][-1]
    assert [field.name for field in cloud.fields] == list(POINT.names)
    assert [f.name for f in cloud.fields if f.datatype == PointField.UINT32] == [
        "material_id",
        "observed_rgb",
    ]
    points = np.frombuffer(bytes(cloud.data), POINT)
    assert len(points) == cloud.width > 100
    known = points[points["material_id"] > 0]
    assert set(known["material_id"]) >= {material.id for material in found.materials}
    places = np.stack([known[name] for name in "xyz"], axis=-1)
    assert (np.linalg.norm(places - CENTRE, axis=1) < 0.2).all()
    assert ((known["rho_d_r"] >= 0.0) & (known["rho_d_r"] <= 1.0)).all()
    # The camera sees a red sphere.
    red, blue = (known["observed_rgb"] >> shift & 255 for shift in (16, 0))
    assert (red > blue).mean() > 0.9


def test_markers_and_overlay_show_the_ids(shown):
    texts = [m.text for m in shown["material_markers"][-1].markers if m.ns == "materials"]
    assert [int(text.split(":")[0]) for text in texts] == [
        material.id for material in shown["materials"][-1].materials
    ]
    overlay = shown["overlay"][-1]
    assert (overlay.width, overlay.height, overlay.encoding) == (WIDTH, HEIGHT, "rgb8")


def test_the_material_at_a_point_and_under_a_pixel(shown, peer):
    found = shown["materials"][-1].materials[0]
    points = np.frombuffer(bytes(shown["material_cloud"][-1].data), POINT)
    one = points[points["material_id"] == found.id][0]
    point = Point(x=float(one["x"]), y=float(one["y"]), z=float(one["z"]))
    answer = peer.call(MaterialAt, "material_at", kind=0, point=point)
    assert answer.success, answer.message
    assert answer.material.id == found.id
    assert answer.rho_d[0] == pytest.approx(float(one["rho_d_r"]))
    under = peer.call(MaterialAt, "material_at", kind=1, u=WIDTH / 2, v=HEIGHT / 2)
    assert under.success, under.message
    assert np.linalg.norm([under.position.x, under.position.y, under.position.z] - CENTRE) < 0.2


@pytest.mark.parametrize(
    ("request_", "reason"),
    [
        ({"kind": 0, "point": Point(x=50.0)}, "50.00 m from .* outside of the region of interest"),
        ({"kind": 0, "point": Point(x=0.05, z=0.12)}, "no scanned surface .* scan more"),
        ({"kind": 1, "u": 2.0, "v": 2.0}, "no scanned surface is under the pixel, which"),
        ({"kind": 0, "point": Point(x=math.nan)}, "not finite"),
        ({"kind": 0, "point": Point(x=1e308)}, r"the point lies 1e\+07 m or more from the origin"),
        ({"kind": 1, "u": -1.0}, "not in the image"),
        ({"kind": 1, "u": math.inf}, "not in the image"),
        ({"kind": 9}, "KIND_"),
    ],
    ids=str,
)
def test_a_place_without_a_material_is_an_answer(shown, peer, request_, reason):
    answer = peer.call(MaterialAt, "material_at", **request_)
    assert not answer.success
    assert re.search(reason, answer.message), answer.message
    assert answer.material.estimate.status == BrdfEstimate.STATUS_UNKNOWN


def test_materials_are_not_estimated_where_that_is_turned_off(shown, peer):
    never = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="never")
    assert peer.set_parameter("materials.when", never).successful
    # One thread estimates: a map that was begun before is published before this answer.
    assert peer.call(Estimate, "estimate").success
    peer.wait_for_news()
    maps = peer.count("material maps")
    assert peer.call(Estimate, "estimate").success
    peer.wait_for_news()
    assert peer.count("material maps") == maps


def test_a_reset_empties_map_cloud_and_overlay(shown, peer):
    assert peer.call(Trigger, "reset").success
    peer.wait_until(lambda: not shown["materials"][-1].materials, "the old map is left")
    peer.wait_until(lambda: shown["material_cloud"][-1].width == 0, "the old cloud is left")
    assert shown["material_cloud"][-1].header.frame_id == "world"
    peer.wait_until(lambda: not any(shown["overlay"][-1].data), "the old overlay is left")
    assert (shown["overlay"][-1].width, shown["overlay"][-1].height) == (WIDTH, HEIGHT)
    answer = peer.call(MaterialAt, "material_at", kind=0)
    assert not answer.success
    assert "no material map yet" in answer.message
