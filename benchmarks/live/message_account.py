# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The fate of every played frame, from the node's own counters."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.measuring.timing import Timing

ROLES = ("rgb", "depth", "camera_info", "pose")
REFUSED = "refused "
NAMED = 4
"""Of the slowest estimates."""
OVERLOAD = ("queue_full",)
"""Causes of a refusal that mean that the node was too slow."""


@dataclass(frozen=True)
class TimedEstimate:
    """When an estimate was published.

    Attributes:
        stamp: Of the keyframe, seconds.
        latency: Seconds from the arrival of the keyframe's image to publication.
        stolen: Seconds that the hypervisor took from this virtual machine since the estimate
            before, summed over cores.
    """

    stamp: float
    latency: float
    stolen: float


def account(
    frames: int, diagnostics: Mapping[str, str], estimates: Sequence[TimedEstimate]
) -> dict[str, Any]:
    """The figures of a live run.

    Each frame is fused, skipped as redundant, or lost. Messages are lost to overload in transport
    or at the queue; the other messages of their frames are then refused. The node counts redundant
    frames among the fused.

    Args:
        frames: Number of played frames, each one message of every role.
        diagnostics: The node's latest values.
        estimates: When each estimate was published.
    """
    latencies = [estimate.latency for estimate in estimates]
    received = {role: _count(diagnostics, f"messages {role}") for role in ROLES}
    refused = {
        name.removeprefix(REFUSED): int(value)
        for name, value in diagnostics.items()
        if name.startswith(REFUSED)
    }
    lost = {"on the way (DDS)": sum(frames - number for number in received.values())}
    lost |= {cause: refused.get(cause, 0) for cause in OVERLOAD}
    taken, redundant = (_count(diagnostics, f"frames {name}") for name in ("fused", "redundant"))
    timing = Timing.of("estimate latency", latencies) if latencies else None
    return {
        "messages_sent": frames * len(ROLES),
        "messages_received": sum(received.values()),
        "frames_played": frames,
        "frames_matched": _count(diagnostics, "frames matched"),
        "frames_fused": taken - redundant,
        "frames_redundant": redundant,
        "frames_lost": frames - taken,
        "messages_lost": lost,
        "refused": {cause: number for cause, number in refused.items() if cause not in OVERLOAD},
        "keyframes": _count(diagnostics, "keyframes"),
        "keyframes_skipped": _count(diagnostics, "keyframes skipped"),
        "estimates": len(latencies),
        "latency": dataclasses.asdict(timing) if timing else None,
        "slowest": _slowest(estimates),
        "stolen_s": sum(estimate.stolen for estimate in estimates),
        "voxels": _count(diagnostics, "voxels"),
        "observations": _count(diagnostics, "observations"),
        "views": _count(diagnostics, "views"),
    }


def _slowest(estimates: Sequence[TimedEstimate]) -> list[dict[str, float]]:
    """The slowest first: what they took, when, and what the host took from the machine then."""
    slowest = sorted(estimates, key=lambda estimate: -estimate.latency)[:NAMED]
    return [
        {
            "latency_ms": 1000.0 * estimate.latency,
            "at_s": estimate.stamp - estimates[0].stamp,
            "stolen_ms": 1000.0 * estimate.stolen,
        }
        for estimate in slowest
    ]


def _count(diagnostics: Mapping[str, str], name: str) -> int:
    return int(diagnostics.get(name, "0"))
