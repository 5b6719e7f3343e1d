# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a display sees of a node in another process.

The tests of this module share one node and go on from one another's scan.
"""

from __future__ import annotations

import numpy as np
import pytest
from cloud_reader import colours, column
from rcl_interfaces.msg import ParameterType, ParameterValue
from sensor_msgs.msg import Image, PointCloud2
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

from reflest_core.rendering.voxel_colours import view_count_colours
from reflest_ros.inputs.core_messages import stamp_to_ns
from reflest_ros.srv import Estimate

FRAMES = 24
TOPICS = {
    "/reflectance/preview": Image,
    "/reflectance/voxels": PointCloud2,
    "/reflectance/environment": Image,
    "/reflectance/environment/coverage": Image,
    "/reflectance/environment/preview": Image,
    "/reflectance/markers": MarkerArray,
}


@pytest.fixture(scope="module")
def shown(node, peer, start, sphere_bag):
    """The messages of each topic since one subscribed, which was after the bag was played."""
    player = start("reflest_ros.bag_player", sphere_bag, "--rate", "4")
    assert player.exit_code() == 0, player.output
    peer.wait_for_count("frames fused", FRAMES)
    peer.wait_for_keyframes()
    asked_for = stamp_to_ns(peer.call(Estimate, "estimate").estimate.header.stamp)
    peer.wait_until(
        lambda: [one.stamp_ns for one in peer.estimates[-1:]] == [asked_for], "no estimate came"
    )
    messages = {topic: peer.listen(kind, topic) for topic, kind in TOPICS.items()}
    for topic, received in messages.items():
        peer.wait_until(lambda r=received: bool(r), f"nothing on {topic}")
    return messages


def estimate_and_wait(peer, messages):
    """Ask for an estimate, which is shown like that of a keyframe."""
    before = {topic: len(received) for topic, received in messages.items()}
    response = peer.call(Estimate, "estimate")
    assert response.success, response.message
    for topic, received in messages.items():
        peer.wait_until(lambda r=received, t=topic: len(r) > before[t], f"nothing on {topic}")
    return response.estimate


def text(messages):
    (marker,) = (one for one in messages["/reflectance/markers"][-1].markers if one.ns == "values")
    return marker.text


def test_who_comes_late_sees_the_last_keyframe_once(shown, peer):
    last = peer.estimates[-1].stamp_ns
    for received in shown.values():
        (message,) = received
        header = message.markers[0].header if hasattr(message, "markers") else message.header
        assert stamp_to_ns(header.stamp) == last


def cameras(messages):
    """Points of the pyramids of the keyframes' cameras."""
    markers = messages["/reflectance/markers"][-1].markers
    return sum(len(one.points) for one in markers if one.ns == "keyframes")


def test_requests_do_not_add_cameras(shown, peer):
    estimate_and_wait(peer, shown)
    before = cameras(shown)
    for _ in range(2):
        estimate_and_wait(peer, shown)
    assert cameras(shown) == before > 0


def test_all_show_the_same_estimate(shown, peer):
    estimate = estimate_and_wait(peer, shown)
    preview = shown["/reflectance/preview"][-1]
    cloud = shown["/reflectance/voxels"][-1]
    assert preview.header == estimate.header
    assert (preview.width, preview.height, preview.encoding) == (256, 256, "rgb8")
    assert cloud.header.stamp == estimate.header.stamp
    assert cloud.header.frame_id == "world"
    assert cloud.width == estimate.voxel_count
    assert f"alpha  {estimate.alpha:.3f}" in text(shown)
    for marker in shown["/reflectance/markers"][-1].markers:
        assert marker.header == cloud.header


def test_the_light_is_shown_with_what_was_seen_of_it(shown, peer):
    light = shown["/reflectance/environment"][-1]
    coverage = shown["/reflectance/environment/coverage"][-1]
    preview = shown["/reflectance/environment/preview"][-1]
    assert (light.height, light.width, light.encoding) == (128, 256, "32FC3")
    assert (preview.height, preview.width, preview.encoding) == (128, 256, "rgb8")
    assert light.header == coverage.header == preview.header
    assert light.header.frame_id == "world"
    radiance = np.frombuffer(light.data, np.float32)
    assert radiance.min() >= 0.0 < radiance.max()
    codes = np.frombuffer(coverage.data, np.uint8)
    assert 0.05 < (codes > 0).mean() < 1.0


def test_the_keyframes_are_remembered_though_nobody_looked(shown):
    markers = shown["/reflectance/markers"][-1].markers
    (cameras,) = (one for one in markers if one.ns == "keyframes")
    assert len(cameras.points) >= 2 * 16
    (region,) = (one for one in markers if one.ns == "region")
    assert region.scale.x == 0.35


def test_the_colouring_can_be_changed_while_it_runs(shown, peer):
    views = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="views")
    assert peer.set_parameter("voxels.colour", views).successful
    few = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=100)
    assert peer.set_parameter("voxels.max_points", few).successful
    estimate_and_wait(peer, shown)
    cloud = shown["/reflectance/voxels"][-1]
    assert cloud.width == 100
    counts = column(cloud, "views").astype(np.int64)
    np.testing.assert_array_equal(colours(cloud), view_count_colours(counts, 64))

    nonsense = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="pink")
    refused = peer.set_parameter("voxels.colour", nonsense)
    assert not refused.successful
    assert "observed, views, estimate" in refused.reason


def test_a_reset_empties_every_view(shown, peer):
    assert peer.call(Trigger, "reset").success
    clouds, markers = shown["/reflectance/voxels"], shown["/reflectance/markers"]
    peer.wait_until(lambda: clouds[-1].width == 0, "the cloud was not emptied")
    coverages = shown["/reflectance/environment/coverage"]
    peer.wait_until(lambda: not any(coverages[-1].data), "the light was not forgotten")
    peer.wait_until(
        lambda: markers[-1].markers[0].action == Marker.DELETEALL, "markers were not deleted"
    )
    assert clouds[-1].header.frame_id == "world"
    spheres = shown["/reflectance/preview"]
    peer.wait_until(lambda: not any(spheres[-1].data), "the old sphere is left")
    assert (spheres[-1].width, spheres[-1].height) == (256, 256)
