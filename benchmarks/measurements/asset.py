# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The time to export a scanned scene as a textured glTF file."""

from __future__ import annotations

import time
from typing import Any

from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused
from reflest_core.estimation.pipeline import EVERY_VOXEL, Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.export.exporter import FORMATS
from reflest_core.export.scan_asset import AssetSettings, scan_asset


def measure(capture: str, frames: int, exports: int) -> dict[str, Any]:
    """Scan frames without a region, then export the scan several times.

    The first export, which imports the libraries, is not timed.

    Args:
        capture: Path of the capture.
        frames: Number of frames to scan.
        exports: Number of timed exports.

    Returns:
        ``median_ms`` of an export, and the sizes of scan and files.
    """
    pipeline = Pipeline(ReflestSettings())
    fused = 0
    for frame in open_capture(capture):
        try:
            pipeline.fuse(frame)
        except FrameRefused:
            continue
        fused += 1
        if fused == frames:
            break
    found = pipeline.materials(pipeline.snapshot(EVERY_VOXEL))
    times, size, faces = [], 0, 0
    for _ in range(exports + 1):
        started = time.perf_counter()
        asset = scan_asset(pipeline.scan, found, "scene", AssetSettings())
        files = FORMATS["glb"].files(asset, "scene.glb")
        times.append(1e3 * (time.perf_counter() - started))
        size = sum(len(content) for content in files.values())
        faces = len(asset.mesh.faces)
    timed = sorted(times[1:])
    return {
        "median_ms": timed[len(timed) // 2],
        "voxels": pipeline.scan.voxel_count,
        "materials": len(found.materials),
        "faces": faces,
        "bytes": size,
    }
