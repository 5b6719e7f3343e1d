# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The sentence about publishers that cannot be heard, for each policy."""

from __future__ import annotations

import pytest
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from reflest_ros.inputs.qos import qos_problem, unseen_problem

RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
VOLATILE, LATCHED = DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL


def qos(reliability, durability):
    return QoSProfile(depth=1, reliability=reliability, durability=durability)


def publisher(reliability, durability, name="driver"):
    return TopicEndpointInfo(
        node_name=name, node_namespace="/camera", qos_profile=qos(reliability, durability)
    )


@pytest.mark.parametrize("reliability", [RELIABLE, BEST_EFFORT])
@pytest.mark.parametrize("durability", [VOLATILE, LATCHED])
def test_best_effort_and_volatile_hear_everyone(reliability, durability):
    publishers = [publisher(reliability, durability)]
    assert qos_problem("/rgb", publishers, qos(BEST_EFFORT, VOLATILE)) == ""


def test_a_best_effort_publisher_of_a_reliable_subscriber():
    problem = qos_problem("/rgb", [publisher(BEST_EFFORT, VOLATILE)], qos(RELIABLE, VOLATILE))
    assert problem == (
        "/rgb is not received: /camera/driver offers reliability best_effort while reliable is "
        "requested. Set input.reliability (or qos_overrides./rgb.subscription.reliability) to "
        "best_effort, or let the publisher be reliable"
    )


def test_a_volatile_publisher_of_a_latched_subscriber():
    problem = qos_problem("/tf_static", [publisher(RELIABLE, VOLATILE)], qos(RELIABLE, LATCHED))
    assert "offers durability volatile while transient_local is requested" in problem
    assert "qos_overrides./tf_static.subscription.durability to volatile" in problem


def test_only_those_that_are_not_heard_are_named():
    publishers = [publisher(RELIABLE, VOLATILE, "good"), publisher(BEST_EFFORT, VOLATILE, "bad")]
    problem = qos_problem("/rgb", publishers, qos(RELIABLE, VOLATILE))
    assert "/camera/bad" in problem
    assert "good" not in problem


def test_a_node_whose_name_is_not_known_yet_is_a_publisher():
    unnamed = publisher(BEST_EFFORT, VOLATILE, "_NODE_NAME_UNKNOWN_")
    problem = qos_problem("/rgb", [unnamed], qos(RELIABLE, VOLATILE))
    assert "a publisher offers reliability best_effort" in problem


def test_a_publisher_that_is_not_listed_yet_is_recognised_by_its_policy():
    problem = unseen_problem("/rgb", QoSPolicyKind.RELIABILITY)
    assert "/rgb is not received" in problem
    assert "qos_overrides./rgb.subscription.reliability" in problem
