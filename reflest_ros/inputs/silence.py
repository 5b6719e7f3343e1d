# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Watches for inputs without messages, and for a clock that goes back."""

from __future__ import annotations

import time
from collections.abc import Callable

from rclpy.clock import JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from reflest_ros.inputs.subscriptions import Input


class SilenceWatch:
    """Warns once each time that inputs fall silent, with what is known about their publishers."""

    def __init__(self, node: Node, inputs: list[Input], limit: float) -> None:
        """Begin to watch.

        Args:
            node: Logs the warnings.
            inputs: The topics.
            limit: Seconds without a message after which a topic is silent.
        """
        self._node = node
        self._inputs = [one for one in inputs if one.is_awaited]
        self._limit = limit
        self._silent: set[str] = set()

    def check(self) -> str:
        """Look for silent topics; log a warning where one has become silent.

        Returns:
            One sentence about the topics that are silent now, or "".
        """
        now = time.monotonic()
        silent = [one for one in self._inputs if now - one.last_arrival > self._limit]
        topics = {one.topic for one in silent}
        sentence = self._sentence(silent) if silent else ""
        if topics - self._silent:
            self._node.get_logger().warning(sentence)
        self._silent = topics
        return sentence

    def _sentence(self, silent: list[Input]) -> str:
        waits = "; ".join(self._describe(one) for one in silent)
        return (
            f"no message for {self._limit:g} s on {waits}. Remap the topic, set its name under "
            "topics, or start its publisher"
        )

    def _describe(self, one: Input) -> str:
        last = "none yet" if one.last_stamp_ns is None else f"{one.last_stamp_ns / 1e9:.3f} s"
        publishers = self._node.get_publishers_info_by_topic(one.topic)
        known = "; ".join(map(_describe_publisher, publishers)) or "it has no publisher"
        return f"{one.topic} ({one.role.value}; last stamp: {last}; {known})"


def _describe_publisher(publisher: TopicEndpointInfo) -> str:
    name = f"{publisher.node_namespace.rstrip('/')}/{publisher.node_name}"
    qos = publisher.qos_profile
    return f"published by {name}, {qos.reliability.name.lower()}, {qos.durability.name.lower()}"


class ClockWatch:
    """Reports when the node's clock goes back."""

    def __init__(self, node: Node, threshold: float, on_jump: Callable[[str], None]) -> None:
        """Begin to watch.

        Args:
            node: Its clock, simulated or not.
            threshold: Smallest step back that is reported, seconds.
            on_jump: Called with one sentence in the thread that sets the clock; must not block.
        """

        def after(jump: TimeJump) -> None:
            back = -jump.delta.nanoseconds / 1e9
            if back > 0.0:  # otherwise the clock was switched
                on_jump(f"/clock went back by {back:.3f} s: waiting messages are dropped")

        self._handle = node.get_clock().create_jump_callback(
            JumpThreshold(
                min_forward=None,
                min_backward=Duration(nanoseconds=-round(threshold * 1e9)),
                on_clock_change=False,
            ),
            post_callback=after,
        )

    def stop(self) -> None:
        """Stop watching."""
        self._handle.unregister()
