# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The whole live path in one process: bag to messages, frames, fusion, estimates, DDS."""

from __future__ import annotations

import dataclasses
import itertools
import time
from pathlib import Path
from typing import Any

from benchmarks.measurements.estimate_publisher import publishing
from benchmarks.measurements.stages import (
    ASSEMBLE,
    ESTIMATE,
    FRAME,
    FUSE,
    FUSE_DEPTH,
    FUSE_KNOWN,
    FUSE_NEW,
    FUSE_REDUNDANT,
    PUBLISH,
    STAGES,
)
from benchmarks.measuring.resident_memory import peak_mb
from benchmarks.measuring.stage_clock import StageClock
from benchmarks.scene.table_scene import table_settings
from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.estimation.warm_up import warm_up
from reflest_core.fusion.fused_frame import FusedFrame

WHOLE_PATH = (FUSE_NEW, FUSE_KNOWN)
"""Frames that are compared with a peer: those of which nothing was skipped."""


def measure(
    capture: str, frames: int, memory_frames: int, is_table: bool, threads: int
) -> dict[str, Any]:
    """Time every stage, then measure the memory of each.

    Args:
        capture: Path of the capture.
        frames: Number of frames to time.
        memory_frames: Number of frames for the memory, which are not timed.
        is_table: Set the region of interest to the object on the table.
        threads: Threads of fusion and of the network.
    """
    settings = table_settings() if is_table else ReflestSettings()
    settings = dataclasses.replace(
        settings,
        fusion=dataclasses.replace(settings.fusion, threads=threads),
        estimation=dataclasses.replace(settings.estimation, threads=threads),
    )
    clock = StageClock(STAGES)
    pipeline, fuse_ms = _scanned(Path(capture), frames, settings, clock)
    peak = peak_mb()
    with_memory = StageClock(STAGES, with_memory=True)
    _scanned(Path(capture), memory_frames, settings, with_memory)
    return {
        "stages": [dataclasses.asdict(one) for one in clock.timings(with_memory.memory_mb)],
        "fuse_ms": fuse_ms,
        "frames": len(clock.seconds[FRAME]),
        "frames_redundant": len(clock.seconds.get(FUSE_REDUNDANT, [])),
        "voxels": pipeline.scan.voxel_count,
        "observations": pipeline.scan.observation_count,
        "views": pipeline.scan.view_count,
        "peak_mb": peak,
    }


def _scanned(
    path: Path, count: int, settings: ReflestSettings, clock: StageClock
) -> tuple[Pipeline, dict[str, float]]:
    """The scan, and the milliseconds of each frame of the whole path, by image stamp."""
    pipeline = Pipeline(settings)
    warm_up(pipeline.estimator)
    fuse_ms = {}
    with publishing() as publish, clock.watching():
        for frame in itertools.islice(open_capture(path, settings=settings.capture), count):
            started = time.perf_counter()
            with clock.timing(FUSE):
                scanned = pipeline.fuse(frame)
            milliseconds = 1000.0 * (time.perf_counter() - started)
            lap = clock.lap()
            kind = _kind(scanned.fused)
            clock.seconds[kind].append(lap[FUSE])
            if kind in WHOLE_PATH:
                fuse_ms[str(frame.stamp_ns)] = milliseconds
            clock.seconds[FRAME].append(lap[ASSEMBLE] + lap[FUSE])
            if scanned.keyframe is not None:
                with clock.timing(ESTIMATE):
                    estimate = pipeline.estimate(scanned.keyframe)
                with clock.timing(PUBLISH):
                    publish(estimate)
                clock.lap()
    return pipeline, fuse_ms


def _kind(fused: FusedFrame) -> str:
    if fused.is_redundant:
        return FUSE_REDUNDANT
    if fused.view is not None and fused.surface_voxels == 0:
        return FUSE_DEPTH
    return FUSE_NEW if fused.is_new_view else FUSE_KNOWN
