# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How each topic is received and sent."""

from __future__ import annotations

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

OUTPUT_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
"""The last estimate stays readable for those who subscribe later."""

INPUT_DEPTH = 30
"""Messages that DDS holds for a callback; callbacks only queue, so that few ever wait."""

TF_DEPTH = 100


def input_qos(reliability: str) -> QoSProfile:
    """Quality of service of the inputs; ``reliability`` is best_effort or reliable."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=INPUT_DEPTH,
        reliability=ReliabilityPolicy[reliability.upper()],
        durability=DurabilityPolicy.VOLATILE,
    )


def tf_qos(is_static: bool) -> QoSProfile:
    """Quality of service of ``/tf`` and ``/tf_static``, as tf2's listener asks for."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=TF_DEPTH,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if is_static else DurabilityPolicy.VOLATILE,
    )
