# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The time of a frame against voxel size, resolution and region.

Every frame is a new view: none is skipped as redundant, so this is the upper bound of the time.
"""

from __future__ import annotations

import dataclasses
import time
from typing import Any

from benchmarks.measurements.stages import FUSE
from benchmarks.measuring.timing import Timing
from benchmarks.scene.recording import Recording, rendered_frames
from benchmarks.scene.table_scene import REGION
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.warm_up import warm_up

RATE = 6.0
"""Frames a second of the orbit: 2.5 degrees between two views."""
REGIONS = {
    "object": REGION,
    "table top": RegionSettings("box", (0.0, 0.0, 0.15), (1.2, 1.2, 0.4)),
    "none (within the work radius)": RegionSettings(),
}
FIRST_FRAMES = 2
"""Not counted: they find an empty scan."""
BUDGET_MB = 2048.0
"""Enough for all of them: what does not fit would cost nothing."""


def measure(
    frames: int,
    resolution: list[int],
    voxel_sizes: list[float],
    resolutions: list[list[int]],
) -> dict[str, Any]:
    """Measure voxel sizes and regions at one resolution, and resolutions at 5 mm.

    Args:
        frames: Number of frames of each case.
        resolution: Width and height for voxel sizes and regions.
        voxel_sizes: Millimetres.
        resolutions: Pairs of width and height.
    """
    warm_up()
    fusion = FusionSettings(memory_budget_mb=BUDGET_MB)
    default = Recording(resolution[0], resolution[1], frames, RATE)
    return {
        "voxel_size": [
            {
                "voxel_size_mm": size,
                **_fused(default, dataclasses.replace(fusion, voxel_size=size / 1000.0), REGION),
            }
            for size in voxel_sizes
        ],
        "resolution": [
            {
                "width": width,
                "height": height,
                **_fused(Recording(width, height, frames, RATE), fusion, REGION),
            }
            for width, height in resolutions
        ],
        "region": [
            {"region": name, **_fused(default, fusion, region)} for name, region in REGIONS.items()
        ],
    }


def _fused(recording: Recording, fusion: FusionSettings, region: RegionSettings) -> dict[str, Any]:
    scan = Scan(fusion, region)
    seconds = []
    for frame in rendered_frames(recording):
        started = time.perf_counter()
        scan.fuse(frame)
        seconds.append(time.perf_counter() - started)
    return {
        "fuse": dataclasses.asdict(Timing.of(FUSE, seconds[FIRST_FRAMES:])),
        "voxels": scan.voxel_count,
        "observations": scan.observation_count,
    }
