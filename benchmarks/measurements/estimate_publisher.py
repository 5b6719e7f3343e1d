# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Publishes estimates over DDS as the node does, to a subscriber in the same process."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

import rclpy
from rclpy.context import Context

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_ros.inputs.qos import OUTPUT_QOS
from reflest_ros.msg import BrdfEstimate as BrdfEstimateMessage
from reflest_ros.outputs.estimate_message import estimate_to_message
from reflest_ros.process import use_private_domain

TOPIC = "/benchmark/brdf"


@contextlib.contextmanager
def publishing() -> Iterator[Callable[[BrdfEstimate], None]]:
    """A context with a function that converts and publishes one estimate."""
    use_private_domain()
    context = Context()
    rclpy.init(context=context)
    node = rclpy.create_node("reflest_benchmark", context=context)
    try:
        publisher = node.create_publisher(BrdfEstimateMessage, TOPIC, OUTPUT_QOS)
        node.create_subscription(BrdfEstimateMessage, TOPIC, lambda _: None, OUTPUT_QOS)
        yield lambda estimate: publisher.publish(estimate_to_message(estimate))
    finally:
        node.destroy_node()
        context.try_shutdown()
