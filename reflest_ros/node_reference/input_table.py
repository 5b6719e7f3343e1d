# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The inputs under every setting that changes them."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, replace

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile

from reflest_core.capture.messages import Role
from reflest_core.capture.settings import CaptureSettings
from reflest_core.parameter import info_of
from reflest_ros.inputs.input_topics import TF_TOPICS, input_topics
from reflest_ros.inputs.qos import tf_qos
from reflest_ros.node_reference.live_node import type_name
from reflest_ros.settings import InputSettings, NodeSettings, TopicSettings

RAW = (NodeSettings(), CaptureSettings(use_mask=True))
ODOMETRY = (NodeSettings(), CaptureSettings(pose_source="odom"))
COMPRESSED = (
    replace(
        NodeSettings(),
        input=InputSettings(
            rgb_transport="compressed",
            depth_transport="compressedDepth",
            mask_transport="compressed",
        ),
    ),
    CaptureSettings(use_mask=True),
)

TF_DESCRIPTIONS = {
    Role.TF: "With capture.pose_source tf or odom, where tf2_msgs is installed.",
    Role.TF_STATIC: "Where tf2_msgs is installed: mounting of the cameras.",
}


@dataclass(frozen=True)
class InputRow:
    """An input of the node.

    Attributes:
        name: To remap.
        parameter: Names the topic where it is not remapped; "" where none does.
        default: The topic's default name.
        message_types: As ``package/msg/Name``, one for each transport.
        qos: What the node requests.
        description: For the page.
    """

    name: str
    parameter: str
    default: str
    message_types: tuple[str, ...]
    qos: QoSProfile
    description: str


def input_rows() -> list[InputRow]:
    """Describe every input.

    Returns:
        One row each, in the order of ``topics``; those of tf come last.
    """
    context = Context()
    rclpy.init(context=context)
    node = rclpy.create_node("reflest_input_table", context=context)
    try:
        topics = [_row(node, field) for field in dataclasses.fields(TopicSettings)]
    finally:
        node.destroy_node()
        context.try_shutdown()
    transforms = [
        InputRow(
            name,
            "",
            name,
            ("tf2_msgs/msg/TFMessage",),
            tf_qos(role is Role.TF_STATIC),
            TF_DESCRIPTIONS[role],
        )
        for role, name in TF_TOPICS.items()
    ]
    return topics + transforms


def _row(node: Node, field: dataclasses.Field[str]) -> InputRow:
    default = str(field.default)
    full = node.resolve_topic_name(default)
    found = [
        topic
        for settings, capture in (RAW, ODOMETRY, COMPRESSED)
        for topic in input_topics(node, settings, capture)
        if topic.name == full or topic.name.startswith(f"{full}/")
    ]
    types = dict.fromkeys(type_name(topic.message_type) for topic in found)
    return InputRow(
        field.name,
        f"topics.{field.name}",
        default,
        tuple(types),
        found[0].qos,
        info_of(field).description,
    )
