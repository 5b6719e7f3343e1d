# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The time of ``reflest replay`` against the duration of the capture."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.measuring.machine import ROOT
from benchmarks.scene.table_scene import REGION


def measure(capture: str, seconds: float) -> dict[str, Any]:
    """Time a replay, with the start of its process.

    Args:
        capture: Path of the capture.
        seconds: Duration of the capture.
    """
    half = [0.5 * edge for edge in REGION.size]
    corners = [c - h for c, h in zip(REGION.centre, half, strict=True)]
    corners += [c + h for c, h in zip(REGION.centre, half, strict=True)]
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "estimates.json"
        command = [sys.executable, "-m", "reflest_core.cli.main", "replay", capture]
        command += ["--json", str(out), "--roi-box", *map(str, corners)]
        started = time.perf_counter()
        subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
        wall = time.perf_counter() - started
        record = json.loads(out.read_text())
    return {
        "filmed_s": seconds,
        "wall_s": wall,
        "times_real_time": seconds / wall,
        "frames": record["frames"],
        "estimates": len(record["estimates"]),
        "peak_mb": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024 / 1e6,
    }
