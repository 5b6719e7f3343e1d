# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scans a corridor far beyond its memory budget and prints what the process grew by.

Run as a script with BUDGET_MB: a fresh process, in which nothing else has left memory behind.
Prints one JSON object.
"""

from __future__ import annotations

import gc
import json
import resource
import sys
from pathlib import Path

import numpy as np

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.frame import Frame
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.warm_up import warm_up

CAMERA = CameraIntrinsics(width=320, height=240, fx=260.0, fy=260.0, cx=159.5, cy=119.5)
STEP = 0.15
"""Metres along the wall from frame to frame: about an eighth of what a frame sees."""

FRAMES = 170
"""25 m of wall."""


def wall_at(n: int) -> Frame:
    """A camera 1 m from the plane z = 1 that moves along x and bobs."""
    T = np.eye(4)
    T[:3, 3] = [STEP * n, 0.05 * np.sin(n), 0.0]
    shape = (CAMERA.height, CAMERA.width)
    rgb = np.full((*shape, 3), n % 256, np.uint8)
    return Frame(n + 1, rgb, np.ones(shape, np.float32), T, CAMERA)


def resident_bytes() -> int:
    """The resident set of this process (Linux)."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


def main(budget_mb: float) -> None:
    warm_up()
    gc.collect()
    before = resident_bytes()
    scan = Scan(
        FusionSettings(memory_budget_mb=budget_mb, threads=2, work_radius=100.0), RegionSettings()
    )
    most, frames, stored = 0, FRAMES, []
    for n in range(FRAMES):
        fused = scan.fuse(wall_at(n))
        stored.append(fused.observations_kept / fused.voxels_seen)
        scan.snapshot()
        most = max(most, resident_bytes() - before)
    print(
        json.dumps(
            {
                "grown": most,
                "reserved": scan.nbytes,
                "frames": frames,
                "voxels": scan.voxel_count,
                "voxel_capacity": scan.store.capacity,
                "observations": scan.observation_count,
                "least_stored": min(stored),
            }
        )
    )


if __name__ == "__main__":
    main(float(sys.argv[1]))
