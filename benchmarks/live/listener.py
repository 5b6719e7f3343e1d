# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A subscriber that collects the node's estimates and its latest diagnostics."""

from __future__ import annotations

import time
from collections.abc import Callable

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from benchmarks.live.message_account import TimedEstimate
from benchmarks.measuring.machine import stolen_seconds
from reflest_core.errors import ReflestError
from reflest_ros.msg import BrdfEstimate

ESTIMATES_KEPT = 1000


class LiveRunFailed(ReflestError):
    """A process of the live run ended early or missed its time limit."""


class Listener:
    """Subscribes to the node's output.

    Attributes:
        estimates: All estimates that were received.
        diagnostics: The node's latest diagnostic values.
        diagnostics_count: Number of diagnostic messages received.
    """

    def __init__(self) -> None:
        self.estimates: list[TimedEstimate] = []
        self._stolen = stolen_seconds()
        self.diagnostics: dict[str, str] = {}
        self.diagnostics_count = 0
        self._context = Context()
        rclpy.init(context=self._context)
        self._node = rclpy.create_node("reflest_benchmark", context=self._context)
        qos = QoSProfile(
            depth=ESTIMATES_KEPT,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
        )
        self._node.create_subscription(BrdfEstimate, "/reflectance/brdf", self._on_estimate, qos)
        self._node.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)

    def listen_until(self, is_true: Callable[[], bool], limit: float, what: str) -> None:
        """Receive messages until a condition holds.

        Args:
            is_true: The condition, checked after every message.
            limit: Seconds.
            what: What is waited for, for the error.

        Raises:
            LiveRunFailed: the condition did not hold in time.
        """
        deadline = time.monotonic() + limit
        while not is_true():
            if time.monotonic() > deadline:
                raise LiveRunFailed(f"{what} did not come to pass within {limit:g} s")
            self._executor.spin_once(timeout_sec=0.1)

    def has_subscriber(self, topic: str) -> bool:
        """Whether some node subscribes to a topic.

        Args:
            topic: The topic's name.
        """
        return bool(self._node.count_subscribers(topic) > 0)

    def close(self) -> None:
        """Destroy the ROS node."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def _on_estimate(self, message: BrdfEstimate) -> None:
        stamp = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
        before, self._stolen = self._stolen, stolen_seconds()
        self.estimates.append(TimedEstimate(stamp, message.latency, self._stolen - before))

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        self.diagnostics = {pair.key: pair.value for pair in message.status[0].values}
        self.diagnostics_count += 1
