# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The other side of the node's topics and services, in the test's process."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.msg import Parameter, ParameterValue, SetParametersResult
from rcl_interfaces.srv import DescribeParameters, GetParameters, SetParameters
from rclpy.client import Client
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile

from reflest_core.estimation.estimate import BrdfEstimate, EstimateStatus
from reflest_ros.inputs.qos import OUTPUT_QOS
from reflest_ros.msg import BrdfEstimate as BrdfEstimateMessage
from reflest_ros.outputs.estimate_message import estimate_from_message

NODE = "/reflest_estimator"
WAIT = 300.0
"""Seconds after which something is broken: no test waits so long for what works."""


class RosPeer:
    """Listens to estimates and diagnostics; publishes and calls what a test asks for.

    ``namespace``: of the node that it is the other side of; "/robot1" or "".
    """

    def __init__(self, domain_id: int, namespace: str = "") -> None:
        self._name = f"{namespace}{NODE}"
        self.estimates: list[BrdfEstimate] = []
        self.unknown: list[BrdfEstimate] = []
        self.diagnostics: dict[str, str] = {}
        self.state = ""
        self.node_time = 0.0
        self.level = DiagnosticStatus.STALE
        self._changed = threading.Condition()
        self._context = Context()
        rclpy.init(context=self._context, domain_id=domain_id)
        self._node = rclpy.create_node("peer", context=self._context)
        self._node.create_subscription(
            BrdfEstimateMessage, f"{namespace}/reflectance/brdf", self._on_estimate, OUTPUT_QOS
        )
        self._node.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)
        self._outputs: dict[str, Publisher] = {}
        self._clients: dict[tuple[type, str], Client] = {}
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._executor.spin, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._executor.shutdown()
        self._thread.join()
        self._node.destroy_node()
        self._context.try_shutdown()

    def wait_until(self, is_true: Callable[[], bool], what: str, timeout: float = WAIT) -> None:
        """Wait for messages until ``is_true``."""
        with self._changed:
            assert self._changed.wait_for(is_true, timeout), f"{what}; got {self.diagnostics}"

    def wait_for_count(self, key: str, at_least: int) -> None:
        """Wait until a diagnostic has come to a number."""
        self.wait_until(lambda: self.count(key) >= at_least, f"{key} < {at_least}")

    def wait_for_news(self) -> None:
        """Wait for diagnostics that were made after this call."""
        for _ in range(2):  # the next ones may be on their way
            before = self.diagnostics
            self.wait_until(lambda old=before: self.diagnostics is not old, "no diagnostics")

    def wait_for_keyframes(self) -> None:
        """Wait until an estimate at every keyframe was made, skipped or refused."""
        ends = ("estimates", "keyframes skipped", "keyframes without an estimate")
        self.wait_until(
            lambda: sum(map(self.count, ends)) == self.count("keyframes"), "an estimate was lost"
        )

    def count(self, key: str) -> int:
        return int(self.diagnostics.get(key, "0"))

    def listen(self, kind: type, topic: str) -> list[Any]:
        """Subscribe to what the node publishes; messages are appended to the list as they come."""
        messages: list[Any] = []

        def take(message: Any) -> None:
            with self._changed:
                messages.append(message)
                self._changed.notify_all()

        self._node.create_subscription(kind, topic, take, OUTPUT_QOS)
        self.wait_until(lambda: self._node.count_publishers(topic) > 0, f"nobody publishes {topic}")
        return messages

    def publish(self, topic: str, message: Any) -> None:
        """Publish reliably, once the node has discovered the topic."""
        if topic not in self._outputs:
            self._outputs[topic] = self._node.create_publisher(type(message), topic, 100)
        output = self._outputs[topic]
        self.wait_until(lambda: output.get_subscription_count() > 0, f"no subscriber of {topic}")
        output.publish(message)

    def offer(self, kind: type, topic: str, qos: QoSProfile) -> Publisher:
        """A publisher of any quality, whether anyone can hear it or not."""
        return self._node.create_publisher(kind, topic, qos)

    def withdraw(self, output: Publisher) -> None:
        """Take a publisher away."""
        self._node.destroy_publisher(output)

    def is_heard(self, topic: str) -> bool:
        """Whether anyone subscribes to a topic that was published before."""
        return self._outputs[topic].get_subscription_count() > 0

    def has_subscriber(self, topic: str) -> bool:
        """Whether anyone subscribes to a topic, once it has been discovered."""
        self.wait_until(lambda: self._node.count_subscribers(topic) > 0, f"nobody hears {topic}")
        return True

    def has_service(self, name: str) -> bool:
        """Whether the node offers a service now."""
        known = dict(self._node.get_service_names_and_types())
        return f"{self._name}/{name}" in known

    def call(self, kind: type, name: str, /, **request: Any) -> Any:
        """Call a service of the node and return its response."""
        client = self._client(kind, name)
        assert client.wait_for_service(WAIT), f"no service {name}"
        done = threading.Event()
        future = client.call_async(kind.Request(**request))
        future.add_done_callback(lambda _: done.set())
        assert done.wait(WAIT), f"{name} did not answer"
        return future.result()

    def parameter(self, name: str) -> ParameterValue:
        return self.call(GetParameters, "get_parameters", names=[name]).values[0]

    def describe(self, names: list[str]) -> list[Any]:
        return list(self.call(DescribeParameters, "describe_parameters", names=names).descriptors)

    def set_parameter(self, name: str, value: ParameterValue) -> SetParametersResult:
        parameter = Parameter(name=name, value=value)
        return self.call(SetParameters, "set_parameters", parameters=[parameter]).results[0]

    def _client(self, kind: type, name: str) -> Client:
        """The client of a service; one for all calls, for a new one must first be discovered."""
        with self._changed:
            if (kind, name) not in self._clients:
                self._clients[kind, name] = self._node.create_client(kind, f"{self._name}/{name}")
            return self._clients[kind, name]

    def _on_estimate(self, message: BrdfEstimateMessage) -> None:
        with self._changed:
            estimate = estimate_from_message(message)
            known = estimate.status is not EstimateStatus.UNKNOWN
            (self.estimates if known else self.unknown).append(estimate)
            self._changed.notify_all()

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        with self._changed:
            (status,) = message.status
            if not status.name.startswith(f"{self._name}:"):
                return
            self.diagnostics = {pair.key: pair.value for pair in status.values}
            self.state, self.level = status.message, status.level
            self.node_time = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
            self._changed.notify_all()
