# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The time of estimates against the size of the scan: surface and views."""

from __future__ import annotations

import dataclasses
import time
from typing import Any

from benchmarks.measurements.stages import ESTIMATE, FUSE, SNAPSHOT
from benchmarks.measuring.resident_memory import resident_mb
from benchmarks.measuring.timing import Timing
from benchmarks.scene.floor import floor_region, overview_frames, small_frames
from benchmarks.scene.recording import Recording, rendered_frames
from benchmarks.scene.table_scene import REGION
from reflest_core.capture.frame import Frame
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.estimation.warm_up import warm_up
from reflest_core.fusion.settings import FusionSettings
from reflest_core.models.registry import shipped_models

BUDGET_BYTES_PER_VOXEL = 1500
"""Enough that nothing of the floor is evicted."""
LAST_FRAMES = 10
"""Frames at the end of a scan over which fusion is timed."""


def measure(
    store_voxels: list[int], voxel_size_mm: float, view_counts: list[int], estimates: int
) -> dict[str, Any]:
    """Scan floors of several sizes, then the table with a growing number of views.

    Args:
        store_voxels: Approximate numbers of voxels of the floors.
        voxel_size_mm: Millimetres.
        view_counts: Numbers of views of the table.
        estimates: Number of estimates for each model and size.
    """
    return {
        "store": [_floor(voxels, voxel_size_mm / 1000.0, estimates) for voxels in store_voxels],
        "views": _table(view_counts, estimates),
    }


def _floor(voxels: int, voxel_size: float, estimates: int) -> dict[str, Any]:
    """After the scan, frames that see the same small part of it each time are timed."""
    edge = voxel_size * voxels**0.5
    budget_mb = max(FusionSettings().memory_budget_mb, BUDGET_BYTES_PER_VOXEL * voxels / 1e6)
    pipeline = Pipeline(
        ReflestSettings(
            region=floor_region(edge),
            fusion=FusionSettings(voxel_size=voxel_size, memory_budget_mb=budget_mb),
        )
    )
    warm_up(pipeline.estimator)
    before = resident_mb()
    for frame in overview_frames(edge):
        pipeline.fuse(frame)
    fuse = [_seconds_to_fuse(pipeline, frame) for frame in small_frames(LAST_FRAMES)]
    return {"wanted_voxels": voxels, **_cost(pipeline, fuse, before, estimates)}


def _table(view_counts: list[int], estimates: int) -> list[dict[str, Any]]:
    """Every frame adds a view."""
    pipeline = Pipeline(ReflestSettings(region=REGION, fusion=FusionSettings(view_spacing=0.0)))
    warm_up(pipeline.estimator)
    before = resident_mb()
    costs, fuse = [], []
    for number, frame in enumerate(rendered_frames(Recording(320, 240, max(view_counts), 6.0)), 1):
        fuse.append(_seconds_to_fuse(pipeline, frame))
        if number in view_counts:
            costs.append(_cost(pipeline, fuse[-LAST_FRAMES:], before, estimates))
    return costs


def _seconds_to_fuse(pipeline: Pipeline, frame: Frame) -> float:
    started = time.perf_counter()
    pipeline.scan.fuse(frame)
    return time.perf_counter() - started


def _cost(
    pipeline: Pipeline, fuse: list[float], before_mb: float, estimates: int
) -> dict[str, Any]:
    """``added_mb``: resident memory beyond that of the empty scan, ``before_mb``."""
    added_mb = max(resident_mb() - before_mb, 0.0)
    snapshot = pipeline.snapshot()
    seconds: dict[str, list[float]] = {SNAPSHOT: []}
    for model in shipped_models():
        pipeline.estimator = Estimator(EstimationSettings(model=model))
        pipeline.estimate(snapshot)
        name = f"{ESTIMATE}, {model}"
        seconds[name] = []
        for _ in range(estimates):
            started = time.perf_counter()
            snapshot = pipeline.snapshot()
            copied = time.perf_counter()
            pipeline.estimate(snapshot)
            seconds[SNAPSHOT].append(copied - started)
            seconds[name].append(time.perf_counter() - copied)
    timings = [Timing.of(FUSE, fuse), *(Timing.of(name, some) for name, some in seconds.items())]
    return {
        "voxels": pipeline.scan.voxel_count,
        "observations": pipeline.scan.observation_count,
        "views": pipeline.scan.view_count,
        "added_mb": added_mb,
        "timings": [dataclasses.asdict(one) for one in timings],
    }
