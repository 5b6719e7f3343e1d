# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Names the inputs that nothing comes from."""

from __future__ import annotations

import time

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from reflest_ros.inputs.subscriptions import Input


class SilenceWatch:
    """Warns once each time that inputs fall silent, with what is known about their publishers."""

    def __init__(self, node: Node, inputs: list[Input], limit: float) -> None:
        self._node = node
        self._inputs = [one for one in inputs if one.is_awaited]
        self._limit = limit
        self._silent: set[str] = set()

    def check(self) -> str:
        """What to know of the topics that are silent now, or ""; logged where one became so."""
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
