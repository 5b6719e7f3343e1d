# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The node's inputs: converts each topic's messages and hands them on."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any, Protocol

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.qos import QoSPolicyKind
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription

from reflest_core.capture.messages import Role, SensorMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.settings import CaptureSettings
from reflest_core.errors import ReflestError
from reflest_ros.inputs.input_topics import InputTopic, input_topics
from reflest_ros.inputs.publication_gaps import PublicationGaps, with_message_info
from reflest_ros.inputs.qos import qos_problem, unseen_problem
from reflest_ros.settings import NodeSettings

OVERRIDABLE = (
    QoSPolicyKind.HISTORY,
    QoSPolicyKind.DEPTH,
    QoSPolicyKind.RELIABILITY,
    QoSPolicyKind.DURABILITY,
)


class MessageSink(Protocol):
    """Takes messages, from any thread."""

    def offer(self, role: Role, message: SensorMessage) -> None:
        """Queue a message.

        Args:
            role: the stream.
            message: converted from ROS.
        """

    def refuse(self, refusal: FrameRefused) -> None:
        """Count what could not even become a message.

        Args:
            refusal: with its cause.
        """


@dataclass
class Input:
    """State of one topic.

    Attributes:
        role: What its messages are to the scan.
        topic: Full name.
        is_awaited: Whether its silence is worth a warning.
        count: Messages received.
        publishers: Publishers that are received now.
        last_arrival: Of its last message, or of the subscription; ``time.monotonic``.
        last_stamp_ns: Of its last message, None before the first.
        qos_problem: A sentence about publishers that cannot be received, or "".
        count_at_problem: Messages that had been received when it was found.
    """

    role: Role
    topic: str
    is_awaited: bool = True
    count: int = 0
    publishers: int = 0
    last_arrival: float = 0.0
    last_stamp_ns: int | None = None
    qos_problem: str = ""
    count_at_problem: int = 0

    def take(self, message: SensorMessage) -> None:
        """Note the arrival of a message.

        Args:
            message: The message.
        """
        self.count += 1
        self.last_arrival = time.monotonic()
        self.last_stamp_ns = message.stamp_ns


class Inputs:
    """The topics that a scan needs; subscribed to while it is active."""

    def __init__(self, node: Node, settings: NodeSettings, capture: CaptureSettings) -> None:
        """Choose the topics.

        Args:
            node: The node that subscribes.
            settings: Names and transports.
            capture: Which poses and masks are used.

        Raises:
            ReflestError: One of them cannot be received on this machine.
        """
        self._node = node
        self._subscriptions: list[Subscription] = []
        self._listened = [
            (topic, Input(topic.role, topic.name, topic.is_awaited))
            for topic in input_topics(node, settings, capture)
        ]

    @property
    def topics(self) -> dict[Role, str]:
        """The full name of each role's topic."""
        return {topic.role: topic.name for topic, _ in self._listened}

    @property
    def states(self) -> list[Input]:
        """The state of each topic."""
        return [state for _, state in self._listened]

    def activate(self, sink: MessageSink) -> None:
        """Subscribe to each topic.

        Each topic's quality of service can be overridden by the parameters
        ``qos_overrides.TOPIC.subscription.{reliability,durability,history,depth}``.

        Args:
            sink: Gets the messages, in the executor's thread.

        Raises:
            ReflestError: It names the topic of which one of these cannot be used.
        """
        for topic, state in self._listened:
            state.qos_problem = ""
            try:
                self._subscriptions.append(self._subscribed(topic, state, sink))
            except (RuntimeError, ParameterException) as error:
                self.deactivate()
                raise ReflestError(
                    f"{topic.name} cannot be subscribed to: {error}; correct its parameters "
                    f"qos_overrides.{topic.name}.subscription"
                ) from error

        # Together, so that topics which stay silent are named together.
        started = time.monotonic()
        for state in self.states:
            state.last_arrival = started

    def recheck_qos(self) -> None:
        """Drop the problems that are solved; the middleware shows it some time after a message."""
        for topic, state in self._listened:
            if state.qos_problem and state.count > state.count_at_problem:
                state.qos_problem = self._qos_problem(topic)

    def deactivate(self) -> None:
        """Drop the subscriptions."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        self._subscriptions.clear()

    def _subscribed(self, topic: InputTopic, state: Input, sink: MessageSink) -> Subscription:
        gaps = PublicationGaps()

        @with_message_info
        def on_message(message: Any, info: dict[str, Any]) -> None:
            number, publishers = info["publication_sequence_number"], state.publishers
            if lost := gaps.lost_before(number, time.monotonic(), publishers):
                _refuse_lost(topic.name, lost, sink)
            converted = topic.convert(message)
            state.take(converted)
            sink.offer(topic.role, converted)

        def on_matched(event: Any) -> None:
            state.publishers = event.current_count
            gaps.begin()

        return self._node.create_subscription(
            topic.message_type,
            topic.name,
            on_message,
            topic.qos,
            event_callbacks=SubscriptionEventCallbacks(
                incompatible_qos=lambda event: self._on_incompatible_qos(topic, state, event),
                matched=on_matched,
            ),
            qos_overriding_options=QoSOverridingOptions(OVERRIDABLE),
        )

    def _on_incompatible_qos(self, topic: InputTopic, state: Input, event: Any) -> None:
        """Warn of a publisher that has just been found out of reach."""
        unseen = unseen_problem(topic.name, QoSPolicyKind(event.last_policy_kind))
        state.qos_problem = self._qos_problem(topic) or unseen
        state.count_at_problem = state.count
        self._node.get_logger().warning(state.qos_problem)

    def _qos_problem(self, topic: InputTopic) -> str:
        publishers = self._node.get_publishers_info_by_topic(topic.name)
        # rclpy writes the overrides into the profile that it was given.
        return qos_problem(topic.name, publishers, topic.qos)


def _refuse_lost(topic: str, count: int, sink: MessageSink) -> None:
    """Count messages that are missing between two that came."""
    sink.refuse(
        FrameRefused(
            RefusalCause.MESSAGE_LOST,
            f"a message on {topic} was lost between its publisher and this node: give Fast DDS "
            "more shared memory (FASTRTPS_DEFAULT_PROFILES_FILE set to "
            "config/fastdds_large_messages.xml, for both), or set input.reliability to reliable",
            count,
        )
    )
