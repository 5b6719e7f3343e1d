# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Runs all measurements one after another, each in a fresh process."""

from __future__ import annotations

import dataclasses
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measuring.fresh_process import measured
from benchmarks.measuring.machine import describe_machine
from benchmarks.plan import Plan
from benchmarks.scene.recording import Recording, recorded
from benchmarks.scene.table_scene import VERSION

SCHEMA_VERSION = 1
MEASUREMENTS = "benchmarks.measurements"


def run(plan: Plan, cache: Path, capture: Path | None = None) -> dict[str, Any]:
    """Run all measurements; a full plan takes some minutes.

    Args:
        plan: Sizes of the measurements.
        cache: Folder of rendered recordings.
        capture: Another capture for the frame path, or None.

    Returns:
        All results, as JSON values.
    """
    recording = Recording(*plan.resolution, plan.live_frames, plan.rate)
    machine = describe_machine()
    bag = str(recorded(recording, cache))
    started = time.monotonic()
    results: dict[str, Any] = {
        "schema_version": SCHEMA_VERSION,
        "scene_version": VERSION,
        "machine": machine,
        "plan": dataclasses.asdict(plan),
        "frame_path": {},
        "open3d": {},
        "against_open3d": {},
        "estimation": {},
    }
    for threads in plan.threads:
        _say(f"frame path, Open3D and estimation with {threads} thread(s)")
        path, peers = _frame_path_and_peers(plan, bag, threads, is_table=True)
        key = str(threads)
        results["against_open3d"][key] = compare_with_open3d(path, peers)
        results["frame_path"][key], results["open3d"][key] = path, peers
        results["estimation"][key] = measured(
            f"{MEASUREMENTS}.estimation",
            threads,
            capture=bag,
            frames=plan.frame_path,
            estimates=plan.estimates,
            threads=threads,
            is_compiled=plan.is_compiled,
        )
    most = max(plan.threads)
    _say("growth with voxel size, resolution and region")
    results["growth_of_fusion"] = measured(
        f"{MEASUREMENTS}.growth_of_fusion",
        most,
        frames=plan.growth_frames,
        resolution=plan.resolution,
        voxel_sizes=plan.voxel_sizes,
        resolutions=plan.resolutions,
    )
    _say("growth with surface and views")
    results["growth_of_estimates"] = measured(
        f"{MEASUREMENTS}.growth_of_estimates",
        most,
        store_voxels=plan.store_voxels,
        voxel_size_mm=plan.store_voxel_size,
        view_counts=plan.view_counts,
        estimates=plan.growth_estimates,
    )
    _say("memory")
    results["memory"] = measured(
        f"{MEASUREMENTS}.memory",
        most,
        frames=plan.memory_strip,
        budget_mb=plan.memory_budget_mb,
        voxel_size_mm=plan.store_voxel_size,
    )
    _say("start-up and replay")
    results["start_up"] = measured(
        f"{MEASUREMENTS}.start_up", most, capture=bag, starts=plan.starts
    )
    results["replay"] = measured(
        f"{MEASUREMENTS}.replay", most, capture=bag, seconds=recording.seconds
    )
    _say(f"live: {recording.seconds:g} s at {plan.rate:g} Hz")
    results["live"] = run_live(recording, bag)
    _say("export of the scene")
    results["asset"] = measured(
        f"{MEASUREMENTS}.asset",
        1,
        capture=bag,
        frames=plan.peer_frames,
        exports=plan.exports,
    )
    _say("materials of the scene")
    results["materials"] = measured(
        f"{MEASUREMENTS}.materials",
        1,
        capture=bag,
        frames=plan.peer_frames,
        step=round(plan.rate / 2.0),
    )
    results["scene"] = _without_region(plan, Path(bag), "the table and all around it")
    if capture is not None:
        results["capture"] = _without_region(plan, capture.resolve(), capture.name)
    results["took_s"] = time.monotonic() - started
    return results


def _without_region(plan: Plan, capture: Path, name: str) -> dict[str, Any]:
    """The frame path and its peers where all within the work radius is scanned."""
    _say(f"frame path of {name}, no region of interest")
    path, peers = _frame_path_and_peers(plan, str(capture), max(plan.threads), is_table=False)
    compared = compare_with_open3d(path, peers)
    return {"name": name, "frame_path": path, "open3d": peers, "against_open3d": compared}


def compare_with_open3d(path: dict[str, Any], peers: dict[str, Any]) -> dict[str, Any]:
    """Compare the whole frame of reflest with Open3D's integration alone, on the same frames.

    Args:
        path: Result of the frame path; its times by stamp (``fuse_ms``) are removed.
        peers: Results of Open3D by name; their times by stamp (``integrate_ms``) are removed.

    Returns:
        By peer: percentiles over the frames that both fused, and their ratio.
    """
    fuse_by_stamp = path.pop("fuse_ms")
    compared: dict[str, Any] = {}
    for name, peer in peers.items():
        integrate_by_stamp = peer.pop("integrate_ms")
        stamps = sorted(set(fuse_by_stamp) & set(integrate_by_stamp))
        fuse = [fuse_by_stamp[stamp] for stamp in stamps]
        integrate = [integrate_by_stamp[stamp] for stamp in stamps]
        compared[name] = {"frames": len(stamps)} | {
            f"p{p}": {
                "fuse_ms": float(np.percentile(fuse, p)),
                "open3d_ms": float(np.percentile(integrate, p)),
                "ratio": float(np.percentile(fuse, p) / np.percentile(integrate, p)),
            }
            for p in (50, 95)
        }
    return compared


def run_live(recording: Recording, bag: str, has_viewer: bool = False) -> dict[str, Any]:
    """Play a recording at its own speed to the node.

    Args:
        recording: What was rendered.
        bag: Its rosbag2 folder.
        has_viewer: Whether the viewer runs beside the node.
    """
    return measured(
        "benchmarks.live.session",
        bag=bag,
        frames=recording.frames,
        seconds=recording.seconds,
        has_viewer=has_viewer,
    )


def _frame_path_and_peers(
    plan: Plan, capture: str, threads: int, is_table: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    # A capture of one's own has no region of interest: each of its frames costs much more.
    frames = plan.frame_path if is_table else plan.peer_frames
    path = measured(
        f"{MEASUREMENTS}.frame_path",
        threads,
        capture=capture,
        frames=frames,
        memory_frames=plan.memory_frames,
        is_table=is_table,
        threads=threads,
    )
    stamps = list(path["fuse_ms"])
    chosen = np.linspace(0, len(stamps) - 1, min(plan.peer_frames, len(stamps))).round().astype(int)
    peers = measured(
        f"{MEASUREMENTS}.open3d_grid",
        threads,
        capture=capture,
        stamps=[stamps[number] for number in chosen],
        is_table=is_table,
    )
    return path, peers


def _say(what: str) -> None:
    print(f"measuring: {what}", file=sys.stderr, flush=True)
