# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest replay --report``: what a replay gave, as one HTML file."""

from __future__ import annotations

from pathlib import Path

from reflest_core.capture.capture import Capture
from reflest_core.cli.replay.printed import ReplayResult, refusals_line
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.export.libraries import library, open3d
from reflest_core.viewer.report.document import report
from reflest_core.viewer.shown_scan import ShownScan
from reflest_core.whole_file import write_whole

FACES = 60_000
"""Triangles of the model in the page: about a megabyte and a half of file."""


def check_report_libraries() -> None:
    """Find out before a long run whether the surface can be extracted.

    Raises:
        ExportError: A package is missing; the sentence has the pip command.
    """
    open3d()
    library("fast_simplification")


def write_report(path: Path, capture: Capture, pipeline: Pipeline, result: ReplayResult) -> None:
    """Write the page; nothing where the replay gave no materials.

    Args:
        path: the file.
        capture: read to its end.
        pipeline: holds the scan.
        result: what came out.

    Raises:
        ReflestError: The file cannot be written, or the scan has no surface.
    """
    if result.materials is None or result.last_fused is None:
        return
    up = pipeline.settings.estimation.up
    scan = ShownScan.of(pipeline.scan, result.materials, up, FACES)
    count = len(result.materials.materials)
    summary = (
        f"{result.fused_count} of {capture.frames_seen} frames used, "
        f"{pipeline.scan.voxel_count:,} voxels of {1000 * scan.voxel_size:g} mm, "
        f"{pipeline.scan.view_count} views, {count} material{'' if count == 1 else 's'}"
    )
    warnings = [
        result.poses.problem,
        result.poses.warning,
        refusals_line(capture),
        capture.damage,
    ]
    page = report(
        scan,
        Path(capture.name).name or capture.name,
        result.last_fused,
        summary,
        [one for one in warnings if one],
    )
    write_whole(path, page)
