# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Two robots in one graph: a namespace each, and nothing of one reaches the other."""

from __future__ import annotations

import pytest
from ros_peer import RosPeer
from sphere_messages import messages_of
from sphere_scene import views
from std_srvs.srv import Trigger

from reflest_ros.srv import Estimate

NAMESPACES = ("/robot1", "/robot2")


@pytest.fixture
def robots(start, settings_file, domain_id):
    """For each namespace a node that is ready, and the other side of it."""
    nodes = [
        start(
            "reflest_ros.estimator",
            "--ros-args",
            "--params-file",
            settings_file,
            "-r",
            f"__ns:={namespace}",
        )
        for namespace in NAMESPACES
    ]
    peers = [RosPeer(domain_id, namespace) for namespace in NAMESPACES]
    for node in nodes:
        node.wait_for_line("listening to", 600.0)
    yield nodes, peers
    for peer in peers:
        peer.close()


def test_what_one_robot_scans_is_its_own(robots):
    nodes, (first, second) = robots
    count = 4
    for view in list(views(8))[:count]:
        for topic, message in messages_of(view):
            first.publish(f"/robot1{topic}", message)
    first.wait_for_count("frames fused", count)
    first.wait_until(lambda: bool(first.estimates), "no estimate of the first robot")
    assert first.call(Estimate, "estimate").success

    second.wait_until(lambda: bool(second.diagnostics), "no diagnostics of the second robot")
    assert second.count("messages rgb") == second.count("voxels") == 0
    assert not second.call(Estimate, "estimate").success
    assert second.call(Trigger, "reset").success
    assert second.call(Trigger, "pause").success
    second.wait_until(lambda: second.state == "paused", "the second robot listens on")
    assert second.estimates == []

    voxels = first.count("voxels")
    first.wait_until(lambda: first.state != "paused", "the first robot was paused as well")
    assert voxels > 0
    for node in nodes:
        node.interrupt()
        assert node.exit_code() == 0, node.output
