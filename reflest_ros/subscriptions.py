"""The node's inputs: each topic's messages, converted and handed on."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image

from reflest_core.capture.messages import Role, SensorMessage
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


@dataclass
class Input:
    """One subscribed topic. ``last_arrival``: of its last message, ``time.monotonic``."""

    role: Role
    topic: str
    last_arrival: float


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


def subscribe(
    node: Node,
    topics: dict[Role, str],
    reliability: str,
    take: Callable[[Role, SensorMessage], None],
) -> list[Input]:
    """Subscribe to each topic; ``take`` gets its messages, in the executor's thread."""
    started = time.monotonic()
    inputs = [Input(role, topic, started) for role, topic in topics.items()]
    for one in inputs:
        message_type, convert = CONVERSIONS[one.role]

        def on_message(
            message: Any, one: Input = one, convert: Callable[[Any], SensorMessage] = convert
        ) -> None:
            one.last_arrival = time.monotonic()
            take(one.role, convert(message))

        node.create_subscription(message_type, one.topic, on_message, input_qos(reliability))
    return inputs
