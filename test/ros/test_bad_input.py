"""Bad messages: one named warning and a count each, and the next good frames are fused.

The tests share one node; each sends views with stamps after all before it.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from sphere_messages import (
    CAMERA_INFO,
    DEPTH,
    POSE,
    RGB,
    camera_info_message,
    depth_message,
    pose_message,
    rgb_message,
)
from sphere_scene import PERIOD_NS, views
from std_srvs.srv import Trigger

from reflest_ros.estimate_message import estimate_from_message
from reflest_ros.srv import Estimate


@pytest.fixture(scope="module")
def next_view():
    """A view of the scene with the next stamp."""
    known = list(views(8))
    count = 0

    def view():
        nonlocal count
        count += 1
        stamp_ns = known[0].stamp_ns + count * PERIOD_NS
        return dataclasses.replace(known[count % len(known)], stamp_ns=stamp_ns)

    return view


def send(peer, view, rgb=None, depth=None, info=None, pose=None):
    peer.publish(CAMERA_INFO, info or camera_info_message(view))
    peer.publish(POSE, pose or pose_message(view))
    peer.publish(DEPTH, depth or depth_message(view))
    peer.publish(RGB, rgb or rgb_message(view))


def send_good(peer, view):
    """Send a good frame and wait until it is fused: the node is alive and its scan is whole."""
    before = peer.count("frames fused")
    send(peer, view)
    peer.wait_for_count("frames fused", before + 1)


def refused_once(node, peer, cause, words):
    """Wait for the count of ``cause``; its one warning must hold ``words``."""
    peer.wait_for_count(f"refused {cause}", 1)
    warning = node.wait_for_line(rf"\(cause: {cause}; said once\)")
    for word in words:
        assert word in warning
    assert len(node.lines_with(rf"cause: {cause};")) == 1


def test_unknown_encoding(node, peer, next_view):
    send_good(peer, next_view())
    for _ in range(2):
        view = next_view()
        send(peer, view, rgb=rgb_message(view, "yuv422_plaid"))
    refused_once(node, peer, "encoding", ["yuv422_plaid", RGB, "rgb8"])
    peer.wait_for_count("refused encoding", 2)
    send_good(peer, next_view())


def test_all_depth_invalid(node, peer, next_view):
    view = next_view()
    send(peer, view, depth=depth_message(dataclasses.replace(view, depth=0 * view.depth)))
    refused_once(node, peer, "depth_empty", [DEPTH])
    send_good(peer, next_view())


def test_nan_pose(node, peer, next_view):
    view = next_view()
    pose = pose_message(view)
    pose.pose.position.x = math.nan
    send(peer, view, pose=pose)
    refused_once(node, peer, "pose_invalid", [POSE])
    send_good(peer, next_view())


def test_truncated_image(node, peer, next_view):
    view = next_view()
    image = rgb_message(view)
    image.data = image.data[: len(image.data) // 2]
    send(peer, view, rgb=image)
    refused_once(node, peer, "truncated", [RGB])
    send_good(peer, next_view())


def test_size_mismatch(node, peer, next_view):
    view = next_view()
    info = camera_info_message(view)
    info.width, info.height = 2 * info.width, 2 * info.height
    send(peer, view, info=info)
    refused_once(node, peer, "size", [CAMERA_INFO])
    send_good(peer, next_view())


def test_time_backwards(node, peer, next_view):
    view = next_view()
    send(peer, dataclasses.replace(view, stamp_ns=view.stamp_ns - 100 * PERIOD_NS))
    refused_once(node, peer, "time_backwards", ["does not come after"])
    send_good(peer, next_view())


def test_float_metres_and_integer_millimetres_agree(node, peer, next_view):
    """The same depth as 16UC1 and as 32FC1, scanned twice from empty, gives the same estimate."""
    known = [next_view() for _ in range(6)]
    estimates = []
    for encoding in ("16UC1", "32FC1"):
        assert peer.call(Trigger, "reset").success
        for view in known:
            millimetres = np.round(view.depth * 1000).astype(np.uint16)
            exact = (millimetres.astype(np.float64) * 0.001).astype(np.float32)
            same = dataclasses.replace(view, depth=exact)
            before = peer.count("frames fused")
            send(peer, same, depth=depth_message(same, encoding))
            peer.wait_for_count("frames fused", before + 1)
        response = peer.call(Estimate, "estimate")
        assert response.success, response.message
        estimates.append(estimate_from_message(response.estimate))
    first, second = (dataclasses.replace(one, latency=math.nan).to_json() for one in estimates)
    assert first == second


def test_the_node_outlived_it_all(node):
    assert node.is_running
    assert "Traceback" not in node.output
