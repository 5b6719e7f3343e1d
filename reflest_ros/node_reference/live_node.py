# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Asks a running node what it offers, so that the page cannot differ from it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile

from reflest_ros.node import EstimatorNode
from reflest_ros.process import ros_process, use_private_domain

STANDARD_PACKAGES = ("rcl_interfaces", "lifecycle_msgs", "type_description_interfaces")
"""Of the topics and services that every managed node has."""

PREFIX = "/reflest_estimator/"


@dataclass(frozen=True)
class OfferedTopic:
    """A topic that the node publishes.

    Attributes:
        name: Its full name.
        message_type: As ``package/msg/Name``.
        qos: What the node offers.
    """

    name: str
    message_type: str
    qos: QoSProfile


@dataclass(frozen=True)
class OfferedService:
    """A service of the node.

    Attributes:
        name: Relative to the node.
        service_type: As ``package/srv/Name``.
        description: First line of the docstring of what answers it.
    """

    name: str
    service_type: str
    description: str


@dataclass(frozen=True)
class NodeFacts:
    """What a node offers.

    Attributes:
        topics: Those that it publishes, by name.
        services: Those that it answers, by name.
        diagnostics: Keys of the status of an active node that has received nothing.
    """

    topics: tuple[OfferedTopic, ...]
    services: tuple[OfferedService, ...]
    diagnostics: tuple[str, ...]


def observe_node() -> NodeFacts:
    """Start an estimator with its defaults, on a domain of its own, and ask it."""
    use_private_domain()
    with ros_process(["--ros-args", "--log-level", "error"]), _active_node() as node:
        topics = sorted(_topics(node), key=lambda one: one.name)
        services = sorted(_services(node), key=lambda one: one.name)
        return NodeFacts(tuple(topics), tuple(services), _diagnostic_keys(node))


@contextmanager
def _active_node() -> Iterator[EstimatorNode]:
    node = EstimatorNode()
    try:
        node.bring_up()
        yield node
    finally:
        node.destroy_node()


def _topics(node: Node) -> Iterator[OfferedTopic]:
    for one in node.publishers:
        name = type_name(one.msg_type)
        if not name.startswith(STANDARD_PACKAGES):
            yield OfferedTopic(one.topic_name, name, one.qos_profile)


def _services(node: EstimatorNode) -> Iterator[OfferedService]:
    for one in node.offered.all:
        name = type_name(one.srv_type)
        if not name.startswith(STANDARD_PACKAGES):
            answer: Callable[..., Any] = one.callback
            sentence = (answer.__doc__ or "").strip().split("\n")[0]
            yield OfferedService(one.service_name.removeprefix(PREFIX), name, sentence)


def _diagnostic_keys(node: Node) -> tuple[str, ...]:
    received: list[DiagnosticArray] = []
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    listener = rclpy.create_node("reflest_node_reference")
    listener.create_subscription(DiagnosticArray, "/diagnostics", received.append, 10)
    executor.add_node(listener)
    while not received:
        executor.spin_once()
    executor.shutdown()
    listener.destroy_node()
    return tuple(pair.key for pair in received[0].status[0].values)


def type_name(interface: type) -> str:
    """``package/msg/Name`` or ``package/srv/Name`` of a generated class.

    Args:
        interface: a message or service type.
    """
    package, kind, *_ = interface.__module__.split(".")
    return f"{package}/{kind}/{interface.__name__}"
