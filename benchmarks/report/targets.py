# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The project's targets for speed and memory, with what was measured."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from benchmarks.measurements.materials import SCRATCH, STEADY
from benchmarks.measurements.stages import ESTIMATE, FROM_STORE, SHIPPED_KIND
from reflest_core.estimation.settings import EstimationSettings

HALF = 0.5
STORE_TO_ESTIMATE = 0.8
"""Of Open3D's colour integration with one thread: lightnet's p95."""
P95_MS = {
    "hemicnn": ("features and network", ESTIMATE, 16.0),
    "grouplet-fast": ("features and network", ESTIMATE, 5.0),
    "grouplet-slow": ("features and network", ESTIMATE, 30.0),
}
"""Of each model: what is promised, the stage that it is measured by, and the limit."""
SCENE = 0.6
"""Of Open3D's colour integration: a frame where all within the work radius is scanned."""
MATERIALS = {STEADY: 20.0, SCRATCH: 100.0}
"""Of Open3D's colour integration: all materials of a scanned scene, with one thread."""
ASSET = 120.0
"""Of Open3D's colour integration: the export of a scanned scene with its texture."""
LATENCY_P99_MS = 100.0
BYTES_PER_OBSERVATION = 6.0
LEVEL = 1.25
"""Times that a median may differ where cost does not grow: what a busy machine adds."""


@dataclass(frozen=True)
class Target:
    """A limit for one figure.

    Attributes:
        what: The figure in words.
        measured: Its value in this run.
        limit: The largest allowed value.
        unit: Of both.
    """

    what: str
    measured: float
    limit: float
    unit: str

    @property
    def is_met(self) -> bool:
        """Whether the measured value is within the limit."""
        return self.measured <= self.limit


def targets(results: dict[str, Any]) -> Iterator[Target]:
    """All targets with the figures of this run.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    most = max(results["against_open3d"], key=int)
    for p, name in (("p50", "median"), ("p95", "p95")):
        colour = results["against_open3d"][most]["colour"][p]
        what = f"whole frame against Open3D's colour integration, {most} threads, {name}"
        yield Target(what, colour["ratio"], HALF, "times")
        if "scene" in results:
            ratio = results["scene"]["against_open3d"]["colour"][p]["ratio"]
            yield Target(f"{what}, no region of interest", ratio, SCENE, "times")
    if "asset" in results:
        frame_ms = results["scene"]["against_open3d"]["colour"]["p50"]["open3d_ms"]
        what = (
            f"glTF of {results['asset']['voxels']:,} voxels, 1 thread, against Open3D's colour "
            f"integration, {most} threads"
        )
        yield Target(what, results["asset"]["median_ms"] / frame_ms, ASSET, "times")
        for one in results["materials"]["timings"]:
            what = (
                f"materials of {results['materials']['voxels']:,} voxels, {one['name']}, median, 1 "
                f"thread, against Open3D's colour integration, {most} threads"
            )
            yield Target(what, one["p50_ms"] / frame_ms, MATERIALS[one["name"]], "times")
    models = results["estimation"]["1"]["models"]
    store_ms = _stage(models["lightnet"], FROM_STORE)["p95_ms"]
    peer_ms = results["against_open3d"]["1"]["colour"]["p50"]["open3d_ms"]
    what = "lightnet, store to estimate, p95, against Open3D's colour integration, 1 thread each"
    yield Target(what, store_ms / peer_ms, STORE_TO_ESTIMATE, "times")
    for model, (what, stage, limit) in P95_MS.items():
        timing = _stage(models[model], stage)
        yield Target(f"{model}, {what}, p95, 1 thread", timing["p95_ms"], limit, "ms")
    for grown in ("store", "views"):
        smallest, *_, largest = results["growth_of_estimates"][grown]
        size = "voxels" if grown == "store" else "views"
        what = f"default estimate, {largest[size]:,} {size} against {smallest[size]:,}, median"
        yield Target(what, _estimate_ms(largest) / _estimate_ms(smallest), LEVEL, "times")
    live = results["live"]
    what = f"frames neither fused nor redundant, {live['seconds']:g} s at the node"
    yield Target(what, float(live["frames_lost"]), 0.0, "frames")
    if live["latency"] is not None:
        p99 = live["latency"]["p99_ms"]
        yield Target("estimate latency at the node, p99", p99, LATENCY_P99_MS, "ms")
    memory = results["memory"]
    what, limit = (
        f"resident memory of a scan, budget {memory['budget_mb']:g} MB",
        memory["budget_mb"],
    )
    yield Target(f"{what}, between frames", memory["between_frames_mb"], limit, "MB")
    observation = memory["bytes_per_observation"]
    yield Target("bytes for each observation", observation, BYTES_PER_OBSERVATION, "bytes")
    slower = 1.0 / results["replay"]["times_real_time"]
    yield Target("replay of a VGA bag, share of its duration", slower, 1.0, "times")


def _stage(kinds: dict[str, Any], stage: str) -> dict[str, Any]:
    """The timing of a stage of a model as it is shipped."""
    return next(one for one in kinds[SHIPPED_KIND] if one["name"] == stage)


def _estimate_ms(scan: dict[str, Any]) -> float:
    name = f"{ESTIMATE}, {EstimationSettings().model}"
    return float(next(one["p50_ms"] for one in scan["timings"] if one["name"] == name))
