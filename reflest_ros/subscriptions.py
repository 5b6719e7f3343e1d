"""The node's inputs: each topic's messages, converted and handed on."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from rclpy.subscription import Subscription
from sensor_msgs.msg import CameraInfo, Image

from reflest_core.capture.messages import Role, SensorMessage
from reflest_core.capture.refusal import FrameRefused
from reflest_core.capture.settings import CaptureSettings
from reflest_ros.core_messages import camera_info_message, image_message, pose_message
from reflest_ros.qos import input_qos
from reflest_ros.settings import NodeSettings

CONVERSIONS: dict[Role, tuple[type, Callable[[Any], SensorMessage]]] = {
    Role.RGB: (Image, image_message),
    Role.DEPTH: (Image, image_message),
    Role.CAMERA_INFO: (CameraInfo, camera_info_message),
    Role.POSE: (PoseStamped, pose_message),
    Role.MASK: (Image, image_message),
}


class MessageSink(Protocol):
    """Where messages go, from any thread."""

    def offer(self, role: Role, message: SensorMessage) -> None:
        """Take a message."""

    def refuse(self, refusal: FrameRefused) -> None:
        """Count what could not even become a message."""


@dataclass
class Input:
    """One topic to subscribe, and what came of it.

    ``last_arrival``: of its last message, or of the subscription; ``time.monotonic``.
    ``last_stamp_ns``: of its last message, None before the first. ``qos_problem``: "" or a sentence
    about publishers that cannot be heard. ``is_awaited``: whether its silence is worth a warning.
    """

    role: Role
    topic: str
    count: int = 0
    last_arrival: float = 0.0
    last_stamp_ns: int | None = None
    qos_problem: str = ""
    is_awaited: bool = True

    def take(self, message: SensorMessage) -> None:
        """Note the arrival of a message."""
        self.count += 1
        self.last_arrival = time.monotonic()
        self.last_stamp_ns = message.stamp_ns


class Inputs:
    """The topics that a scan needs; subscribed to while it is active."""

    def __init__(self, node: Node, settings: NodeSettings, capture: CaptureSettings) -> None:
        self._node = node
        self._settings = settings
        self._subscriptions: list[Subscription] = []
        self.topics = input_topics(node, settings, capture.use_mask)
        self.states = [Input(role, topic) for role, topic in self.topics.items()]

    def activate(self, sink: MessageSink) -> None:
        """Subscribe to each topic; ``sink`` gets the messages, in the executor's threads."""
        qos = input_qos(self._settings.input.reliability)
        for state in self.states:
            message_type, convert = CONVERSIONS[state.role]

            def on_message(
                message: Any, state: Input = state, convert: Callable[[Any], Any] = convert
            ) -> None:
                converted = convert(message)
                state.take(converted)
                sink.offer(state.role, converted)

            self._subscriptions.append(
                self._node.create_subscription(message_type, state.topic, on_message, qos)
            )
        started = time.monotonic()
        for state in self.states:
            state.last_arrival = started

    def deactivate(self) -> None:
        """Drop the subscriptions."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        self._subscriptions.clear()


def input_topics(node: Node, settings: NodeSettings, use_mask: bool) -> dict[Role, str]:
    """Full names of the topics to subscribe; a remapping of ``rgb`` wins over ``topics.rgb``."""
    roles = [role for role in Role if use_mask or role is not Role.MASK]
    topics = {}
    for role in roles:
        resolved = node.resolve_topic_name(role.value)
        is_remapped = resolved != node.resolve_topic_name(role.value, only_expand=True)
        name = role.value if is_remapped else getattr(settings.topics, role.value)
        topics[role] = node.resolve_topic_name(name)
    return topics
