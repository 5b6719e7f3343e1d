# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which topics a scan listens to, of which type, and how each is received."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSProfile
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from reflest_core.capture.messages import Role, SensorMessage
from reflest_core.capture.settings import CaptureSettings
from reflest_core.errors import ReflestError
from reflest_ros.inputs.core_messages import (
    camera_info_message,
    compressed_image_message,
    image_message,
    odometry_message,
    pose_message,
    transforms_message,
)
from reflest_ros.inputs.qos import input_qos, tf_qos
from reflest_ros.settings import NodeSettings

RAW = "raw"
COMPRESSED_SUFFIXES = ("/compressed", "/compressedDepth")
TF_TOPICS = {Role.TF: "/tf", Role.TF_STATIC: "/tf_static"}


@dataclass(frozen=True)
class InputTopic:
    """One topic to subscribe to.

    Attributes:
        role: What its messages are to the scan.
        name: Its full name.
        message_type: The generated class.
        convert: Makes the core's message of one of ROS.
        qos: What is requested; this topic's own profile, for overrides are written into it.
        is_awaited: Whether its silence is worth a warning.
    """

    role: Role
    name: str
    message_type: type
    convert: Callable[[Any], SensorMessage]
    qos: QoSProfile
    is_awaited: bool = True


def input_topics(node: Node, settings: NodeSettings, capture: CaptureSettings) -> list[InputTopic]:
    """List every topic that the settings ask for, under its full name.

    Args:
        node: whose topics they are.
        settings: the parameters.
        capture: parameters of the group ``capture``.

    Returns:
        The topics.

    Raises:
        ReflestError: A name is not one of a topic, or poses shall come from tf and tf2_msgs is
            not installed.
    """
    transports = {
        Role.RGB: settings.input.rgb_transport,
        Role.DEPTH: settings.input.depth_transport,
        **({Role.MASK: settings.input.mask_transport} if capture.use_mask else {}),
    }
    ask = settings.input.reliability
    inputs = []
    for role, transport in transports.items():
        name = _image_topic(_named(node, settings, role.value), transport)
        kind = _image_type(name)
        inputs.append(InputTopic(role, node.resolve_topic_name(name), *kind, input_qos(ask)))
    for role in (Role.CAMERA_INFO, Role.DEPTH_INFO):
        name = _named(node, settings, role.value)
        is_awaited = role is Role.CAMERA_INFO
        qos = input_qos(ask)
        inputs.append(InputTopic(role, name, CameraInfo, camera_info_message, qos, is_awaited))
    if capture.pose_source == "pose":
        name = _named(node, settings, "pose")
        inputs.append(InputTopic(Role.POSE, name, PoseStamped, pose_message, input_qos(ask)))
    elif capture.pose_source == "odom":
        name = _named(node, settings, "odom")
        inputs.append(InputTopic(Role.POSE, name, Odometry, odometry_message, input_qos(ask)))
    return inputs + _transform_topics(node, capture.pose_source)


def _transform_topics(node: Node, pose_source: str) -> list[InputTopic]:
    """tf, where poses come from it or may need it; the static part for depth to be registered."""
    message_type = transform_type()
    if message_type is None:
        if pose_source == "tf":
            raise ReflestError(
                "capture.pose_source is tf, but the package tf2_msgs is not installed: install it "
                "(ros-jazzy-tf2-msgs), or set capture.pose_source to pose or odom"
            )
        return []
    roles = [Role.TF_STATIC] if pose_source == "pose" else [Role.TF_STATIC, Role.TF]
    return [
        InputTopic(
            role,
            node.resolve_topic_name(TF_TOPICS[role]),
            message_type,
            transforms_message,
            tf_qos(is_static=role is Role.TF_STATIC),
            is_awaited=False,
        )
        for role in roles
    ]


def transform_type() -> type | None:
    """``tf2_msgs/TFMessage``, which an installation of rclpy alone does not bring."""
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError:
        return None
    return TFMessage  # type: ignore[no-any-return]


def _named(node: Node, settings: NodeSettings, relative: str) -> str:
    """The full name of an input; a remapping of its relative name wins over ``topics``."""
    resolved: str = node.resolve_topic_name(relative)
    if resolved != node.resolve_topic_name(relative, only_expand=True):
        return resolved
    name = getattr(settings.topics, relative)
    try:
        return str(node.resolve_topic_name(name))
    except RuntimeError as error:
        raise ReflestError(f"topics.{relative} = {name!r} is no topic name: {error}") from error


def _image_topic(base: str, transport: str) -> str:
    """image_transport's name of a transport; a name that ends in one is taken as it is."""
    if transport == RAW or base.endswith(COMPRESSED_SUFFIXES):
        return base
    return f"{base}/{transport}"


def _image_type(topic: str) -> tuple[type, Callable[[Any], SensorMessage]]:
    if topic.endswith(COMPRESSED_SUFFIXES):
        return CompressedImage, compressed_image_message
    return Image, image_message
