# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Publishers that quality of service keeps from being heard are named, with the fix."""

from __future__ import annotations

import pytest
from feed import SOON
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image
from sphere_messages import RGB


@pytest.fixture(scope="module")
def quiet(feed):
    """A best-effort camera for a node that asks for reliable; and the warning about it."""
    best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    output = feed.peer.offer(Image, RGB, best_effort)
    return output


def test_the_warning_names_topic_policies_and_fix(feed, quiet):
    warning = feed.node.wait_for_line(f"{RGB} is not received", SOON)
    for words in (
        " offers reliability best_effort while reliable is requested",
        f"Set input.reliability (or qos_overrides.{RGB}.subscription.reliability)",
        "best_effort",
    ):
        assert words in warning
    assert len(feed.node.lines_with("is not received")) == 1


def test_the_diagnostic_says_so_too(feed, quiet):
    peer = feed.peer
    peer.wait_until(lambda: f"{RGB} is not received" in peer.state, "not in the state", SOON)
    assert RGB in peer.diagnostics["incompatible QoS rgb"]


def test_a_reliable_camera_beside_it_is_heard(feed, quiet):
    feed.send_good()
    assert "incompatible QoS rgb" in feed.peer.diagnostics, "the other one still is not"


def test_when_it_has_gone_the_problem_goes(feed, quiet):
    feed.peer.withdraw(quiet)
    feed.send_good()
    peer = feed.peer
    peer.wait_until(lambda: "incompatible QoS rgb" not in peer.diagnostics, "it stays")
