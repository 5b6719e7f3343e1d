# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The time of all materials of a scene: from scratch, and from one moment of a scan to the next."""

from __future__ import annotations

import dataclasses
import itertools
import time
from typing import Any

from benchmarks.measuring.timing import Timing
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused
from reflest_core.estimation.pipeline import KeyframeSnapshot, Pipeline
from reflest_core.estimation.scan_memory import ScanMemory
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.snapshot import MATERIAL_VOXELS

SCRATCH, STEADY = "from scratch", "steady"
STEPS = 8
"""Moments at which the materials are estimated again."""


def measure(capture: str, frames: int, step: int) -> dict[str, Any]:
    """Scan frames without a region, then estimate all materials again and again.

    Estimates from scratch remember nothing; the steady ones remember what was estimated ``step``
    frames before, as the node does. What comes first of either is not timed.

    Args:
        capture: Path of the capture.
        frames: Number of frames that are scanned first.
        step: Frames between two moments.

    Returns:
        ``timings`` by name, and the voxels and materials at the end.
    """
    pipeline = Pipeline(ReflestSettings())
    source = iter(open_capture(capture))
    _fuse(pipeline, itertools.islice(source, frames))
    snapshot = pipeline.snapshot(MATERIAL_VOXELS)
    scratch = [
        _seconds(pipeline, dataclasses.replace(snapshot, memory=ScanMemory())) for _ in range(3)
    ]
    steady = [_seconds(pipeline, snapshot)]
    for _ in range(STEPS):
        _fuse(pipeline, itertools.islice(source, step))
        snapshot = pipeline.snapshot(MATERIAL_VOXELS)
        steady.append(_seconds(pipeline, snapshot))
    timings = [Timing.of(SCRATCH, scratch[1:]), Timing.of(STEADY, steady[1:])]
    return {
        "timings": [dataclasses.asdict(one) for one in timings],
        "voxels": snapshot.surface.voxel_count,
        "materials": len(pipeline.materials(snapshot).materials),
    }


def _fuse(pipeline: Pipeline, frames: Any) -> None:
    for frame in frames:
        try:
            pipeline.fuse(frame)
        except FrameRefused:
            continue


def _seconds(pipeline: Pipeline, snapshot: KeyframeSnapshot) -> float:
    started = time.perf_counter()
    pipeline.materials(snapshot)
    return time.perf_counter() - started
