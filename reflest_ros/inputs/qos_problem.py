# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Says which publishers of a topic cannot be heard, by which policies, and what to turn."""

from __future__ import annotations

from rclpy.qos import (
    DurabilityPolicy,
    QoSCompatibility,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.qos import qos_check_compatible as check_compatible
from rclpy.topic_endpoint_info import TopicEndpointInfo


def qos_problem(topic: str, publishers: list[TopicEndpointInfo], wanted: QoSProfile) -> str:
    """Return "" where ``wanted`` matches every publisher of ``topic``, else one sentence."""
    unheard = [one for one in publishers if not _is_heard(one, wanted)]
    if not unheard:
        return ""
    described = "; ".join(_described(one, wanted) for one in unheard)
    return f"{topic} is not received: {described}. {_fix(topic, unheard, wanted)}"


def unseen_problem(topic: str, policy: QoSPolicyKind) -> str:
    """Return the sentence about a publisher of which the policy that differs is known alone."""
    name = policy.name.lower()
    return (
        f"{topic} is not received: a publisher offers another {name} than is asked for. Set "
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
        f"{kind} {offer.name.lower()} while {request.name.lower()} is asked for"
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
