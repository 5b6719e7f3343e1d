# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Quality of service of each topic, and which publishers it excludes."""

from __future__ import annotations

from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSCompatibility,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.qos import qos_check_compatible as check_compatible
from rclpy.topic_endpoint_info import TopicEndpointInfo

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
    """Make the quality of service of the inputs.

    Args:
        reliability: best_effort or reliable.

    Returns:
        A profile of its own, for overrides are written into it.
    """
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=INPUT_DEPTH,
        reliability=ReliabilityPolicy[reliability.upper()],
        durability=DurabilityPolicy.VOLATILE,
    )


def tf_qos(is_static: bool) -> QoSProfile:
    """Make the quality of service of ``/tf`` and ``/tf_static``, as tf2's listener requests it.

    Args:
        is_static: Whether it is for ``/tf_static``.

    Returns:
        A profile of its own.
    """
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=TF_DEPTH,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if is_static else DurabilityPolicy.VOLATILE,
    )


def qos_problem(topic: str, publishers: list[TopicEndpointInfo], wanted: QoSProfile) -> str:
    """Describe the publishers of a topic that cannot be received.

    Args:
        topic: Full name.
        publishers: Everyone who publishes it.
        wanted: What the subscription requests.

    Returns:
        One sentence that says what to change; "" where every publisher is received.
    """
    unheard = [one for one in publishers if not _is_heard(one, wanted)]
    if not unheard:
        return ""
    described = "; ".join(_described(one, wanted) for one in unheard)
    return f"{topic} is not received: {described}. {_fix(topic, unheard, wanted)}"


def unseen_problem(topic: str, policy: QoSPolicyKind) -> str:
    """Describe a publisher of which only the policy that differs is known.

    Args:
        topic: Full name.
        policy: The policy that differs.

    Returns:
        One sentence that says what to change.
    """
    name = policy.name.lower()
    return (
        f"{topic} is not received: a publisher offers another {name} than is requested. Set "
        f"qos_overrides.{topic}.subscription.{name} as the publisher's"
    )


def _is_heard(publisher: TopicEndpointInfo, wanted: QoSProfile) -> bool:
    compatibility, _ = check_compatible(publisher.qos_profile, wanted)
    return bool(compatibility != QoSCompatibility.ERROR)


def _described(publisher: TopicEndpointInfo, wanted: QoSProfile) -> str:
    offered = publisher.qos_profile
    name = f"{publisher.node_namespace.rstrip('/')}/{publisher.node_name}"
    if "UNKNOWN" in name:  # its node's name travels apart from the publisher
        name = "a publisher"
    differences = [
        f"{kind} {offer.name.lower()} while {request.name.lower()} is requested"
        for kind, offer, request in (
            ("reliability", offered.reliability, wanted.reliability),
            ("durability", offered.durability, wanted.durability),
        )
        if offer != request
    ]
    return f"{name} offers {' and '.join(differences) or 'another deadline or liveliness'}"


def _fix(topic: str, unheard: list[TopicEndpointInfo], wanted: QoSProfile) -> str:
    override = f"qos_overrides.{topic}.subscription"
    if wanted.reliability == ReliabilityPolicy.RELIABLE and any(
        one.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT for one in unheard
    ):
        return (
            f"Set input.reliability (or {override}.reliability) to best_effort, or let the "
            "publisher be reliable"
        )
    if wanted.durability == DurabilityPolicy.TRANSIENT_LOCAL:
        return f"Set {override}.durability to volatile, or let the publisher be transient_local"
    return f"Set {override} as the publisher's"
