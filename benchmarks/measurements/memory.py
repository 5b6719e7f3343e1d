# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Resident memory of a scan far beyond its memory budget."""

from __future__ import annotations

import gc
from typing import Any

from benchmarks.measuring.resident_memory import forget_peak, peak_mb, resident_mb
from benchmarks.scene.floor import strip_frames
from reflest_core.fusion.memory_budget import WORKING_MB
from reflest_core.fusion.observations.observation_chunks import BYTES_PER_CHUNK, CHUNK
from reflest_core.fusion.observations.observation_store import BYTES_PER_VOXEL
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.warm_up import warm_up


def measure(frames: int, budget_mb: float, voxel_size_mm: float) -> dict[str, Any]:
    """Scan a strip of floor with a snapshot after each frame.

    Args:
        frames: Number of frames.
        budget_mb: The memory budget, 10^6 bytes.
        voxel_size_mm: Millimetres.

    Returns:
        Resident memory beyond that at the start: ``between_frames_mb``, the maximum after a frame
        and its snapshot; ``within_frames_mb``, the maximum at any time, None where the kernel does
        not say.
    """
    warm_up()
    gc.collect()
    settings = FusionSettings(
        voxel_size=voxel_size_mm / 1000.0, memory_budget_mb=budget_mb, work_radius=100.0
    )
    before = resident_mb()
    scan = Scan(settings, RegionSettings())
    between, within = 0.0, 0.0
    is_peak_known = True
    for frame in strip_frames(frames):
        is_peak_known &= forget_peak()
        scan.fuse(frame)
        scan.snapshot()
        within = max(within, peak_mb() - before)
        between = max(between, resident_mb() - before)
    return {
        "budget_mb": budget_mb,
        "working_mb": WORKING_MB,
        "between_frames_mb": between,
        "within_frames_mb": within if is_peak_known else None,
        "voxels": scan.voxel_count,
        "voxel_capacity": scan.store.capacity,
        "observations": scan.observation_count,
        "bytes_per_observation": BYTES_PER_CHUNK / CHUNK,
        "bytes_per_voxel": BYTES_PER_VOXEL,
    }
