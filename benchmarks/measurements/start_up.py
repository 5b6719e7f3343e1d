# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""From the start of a process to its first estimate."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from benchmarks.measuring.machine import ROOT
from benchmarks.measuring.timing import Timing

LATER_FRAMES = 60
"""Frames after the first one, among which the slowest is looked for: a stall would show there."""


def measure(capture: str, starts: int) -> dict[str, Any]:
    """Start processes one after another.

    Args:
        capture: Path of the capture.
        starts: Number of processes.
    """
    runs = [_started(capture) for _ in range(starts)]
    timings = [Timing.of(phase, [run[phase] for run in runs]) for phase in runs[0]]
    return {"phases": [dataclasses.asdict(one) for one in timings]}


def _started(capture: str) -> dict[str, float]:
    """Seconds for each phase of one process."""
    command = [sys.executable, "-m", "benchmarks.measurements.start_up", capture]
    started = time.time()
    done = subprocess.run([*command, repr(started)], cwd=ROOT, check=True, stdout=subprocess.PIPE)
    phases: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return phases


def _first_estimate(capture: Path, started: float) -> dict[str, float]:
    """What the estimator does before its first estimate, in the order of the node."""
    phases = {"interpreter": time.time() - started}
    began = time.time()

    from benchmarks.scene.table_scene import table_settings
    from reflest_core.capture.open_capture import open_capture
    from reflest_core.estimation.pipeline import Pipeline
    from reflest_core.estimation.warm_up import warm_up

    phases["import"] = time.time() - began
    began = time.time()
    pipeline = Pipeline(table_settings())
    phases["load weights, reserve memory"] = time.time() - began
    began = time.time()
    warm_up(pipeline.estimator)
    phases["warm up"] = time.time() - began
    began = time.time()
    frames = iter(open_capture(capture))
    first = next(frames)
    phases["open the bag, first image"] = time.time() - began
    began = time.time()
    pipeline.fuse(first)
    phases["first frame"] = time.time() - began
    began = time.time()
    pipeline.estimate(pipeline.snapshot())
    phases["first estimate"] = time.time() - began
    phases["process start to first estimate"] = time.time() - started
    slowest = 0.0
    for _, frame in zip(range(LATER_FRAMES), frames, strict=False):
        began = time.time()
        scanned = pipeline.fuse(frame)
        if scanned.keyframe is not None:
            pipeline.estimate(scanned.keyframe)
        slowest = max(slowest, time.time() - began)
    phases["slowest of the next frames, estimate included"] = slowest
    return phases


if __name__ == "__main__":
    print(json.dumps(_first_estimate(Path(sys.argv[1]), float(sys.argv[2]))))
