# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sections: the machine, the targets, and whole runs (node, replay, start-up)."""

from __future__ import annotations

from typing import Any

from benchmarks.report.stage_sections import PERCENTILES
from benchmarks.report.table import number, table
from benchmarks.report.targets import targets


def machine_section(results: dict[str, Any]) -> str:
    """Section: hardware and software.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    machine = results["machine"]
    libraries = ", ".join(f"{name} {version}" for name, version in machine["libraries"].items())
    return (
        f"{machine['cpu']}, {machine['cores']} cores, {machine['memory_gb']:g} GB, "
        f"{machine['system']}, Python {machine['python']}; {libraries}. "
        f"Commit {machine['commit']}. Load average at the start {machine['load_at_start']:g}; "
        f"the run took {results['took_s'] / 60:.0f} minutes.\n"
    )


def targets_section(results: dict[str, Any]) -> str:
    """Section: targets against measurements.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    rows = [
        (one.what, f"{number(one.limit)} {one.unit}", number(one.measured), _yes(one.is_met))
        for one in targets(results)
    ]
    return table(("target", "at most", "measured", "met"), rows)


def live_section(results: dict[str, Any]) -> str:
    """Section: a bag played to the node.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    live = results["live"]
    lost = ", ".join(f"{cause}: {count}" for cause, count in live["messages_lost"].items())
    refused = ", ".join(f"{cause}: {count}" for cause, count in live["refused"].items())
    latency = live["latency"] or {}
    rows = [
        ["messages sent", f"{live['messages_sent']:,}"],
        ["messages received", f"{live['messages_received']:,}"],
        ["frames matched", f"{live['frames_matched']:,}"],
        ["frames fused", f"{live['frames_fused']:,}"],
        ["frames skipped as redundant", f"{live['frames_redundant']:,}"],
        ["frames lost", f"{live['frames_lost']:,}"],
        ["messages lost to overload", lost],
        ["refused for other reasons", refused or "0"],
        ["keyframes", str(live["keyframes"])],
        ["keyframes skipped for a newer one", str(live["keyframes_skipped"])],
        ["estimates", str(live["estimates"])],
        *([f"estimate latency {p[:3]}", f"{number(latency.get(p))} ms"] for p in PERCENTILES),
        *(["estimate latency, among the slowest", _slow(one)] for one in live["slowest"]),
        ["taken by the host from this virtual machine", f"{live['stolen_s']:.1f} s"],
        ["peak resident memory of the node", f"{live['peak_mb']:,.0f} MB"],
        ["cores that the node kept busy", number(live["cores_used"])],
        ["node's start to subscribed", f"{live['start_up_s']:.1f} s"],
    ]
    return table((f"{live['seconds']:g} s, {live['frames_played']:,} frames", ""), rows)


def viewer_section(live: dict[str, Any]) -> str:
    """Section: the same bag with and without ``ros2 run reflest_ros viewer`` beside the node.

    Args:
        live: Result of the live run, with the other one below ``with_viewer``.
    """
    both = live, live["with_viewer"]
    taken = [one["frames_fused"] + one["frames_redundant"] for one in both]
    rows = [
        ["frames taken", *(f"{count:,}" for count in taken)],
        ["estimates", *(str(one["estimates"]) for one in both)],
        [
            "estimate latency p50, ms",
            *(number((one["latency"] or {}).get(PERCENTILES[0])) for one in both),
        ],
        ["cores that the node kept busy", *(number(one["cores_used"]) for one in both)],
        ["frames that the viewer costs", "", f"{1.0 - taken[1] / max(taken[0], 1):.1%}"],
    ]
    return table(("", "node alone", "with the viewer"), rows)


def _slow(one: dict[str, float]) -> str:
    return (
        f"{number(one['latency_ms'])} ms, {one['at_s']:.0f} s after the first "
        f"(the host took {number(one['stolen_ms'])} ms since the one before)"
    )


def memory_section(results: dict[str, Any]) -> str:
    """Section: resident memory of a scan that is too large for its budget.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    memory = results["memory"]
    rows = [
        ["memory_budget_mb", number(memory["budget_mb"])],
        ["resident, the most between two frames", number(memory["between_frames_mb"])],
        ["resident, the most within a frame", number(memory["within_frames_mb"])],
        ["stated allowance for the frame in hand", number(memory["working_mb"])],
        ["voxels (room for)", f"{memory['voxels']:,} ({memory['voxel_capacity']:,})"],
        ["observations", f"{memory['observations']:,}"],
        ["bytes for each observation", number(memory["bytes_per_observation"])],
        ["bytes for each voxel on top", number(memory["bytes_per_voxel"])],
    ]
    return table(("a floor without end (MB beyond the empty process)", ""), rows)


def start_up_section(results: dict[str, Any]) -> str:
    """Section: phases of start-up, and replay speed.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    rows = [[one["name"], number(one["p50_ms"])] for one in results["start_up"]["phases"]]
    replay = results["replay"]
    return (
        table(("start-up", "p50 ms"), rows)
        + f"\n`reflest replay` of {replay['filmed_s']:g} s of VGA took {replay['wall_s']:.1f} s, "
        f"its start included: {replay['times_real_time']:.1f} times real time, "
        f"{replay['estimates']} estimates, {replay['peak_mb']:,.0f} MB at its peak.\n"
    )


def _yes(is_met: bool) -> str:
    return "yes" if is_met else "**no**"
