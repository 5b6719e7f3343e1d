# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The replay itself: capture to frames, frames to scan, keyframes to estimates."""

from __future__ import annotations

import argparse
import sys
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from tqdm import tqdm

from reflest_core.capture.capture import Capture
from reflest_core.capture.refusal import CaptureError, FrameRefused
from reflest_core.cli.output_files import write_json
from reflest_core.cli.replay.printed import (
    ReplayResult,
    estimate_line,
    final_lines,
    material_lines,
    refusals_line,
    replay_record,
)
from reflest_core.cli.scan_options import is_saved
from reflest_core.cli.scan_settings import scan_settings
from reflest_core.cli.source import open_source
from reflest_core.estimation.estimator import NoEstimate
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.export.environment_file import export_environment, light_format
from reflest_core.export.errors import check_suffix
from reflest_core.export.material_ply import export_materials
from reflest_core.fusion.scan_file import is_scan_file
from reflest_core.jit import announce_compilation


def replay(options: argparse.Namespace) -> None:
    """Run ``reflest replay``.

    Args:
        options: all options of the command.

    Raises:
        ReflestError: a bad option, an unreadable capture, or no estimate at its end.
    """
    if options.report is not None:
        from reflest_core.cli.replay.html_report import check_report_libraries, write_report

        check_report_libraries()
    _check_no_scan(options.capture)
    light_kind = light_format(options.environment) if options.environment else ""
    if options.materials is not None:
        check_suffix(options.materials, ".ply", "ply")
    settings = scan_settings(options)
    announce_compilation()
    capture = open_source(
        options,
        settings.capture,
        on_refusal=_warn_of_refusal,
        on_clock_jump=lambda _: pipeline.restart_clock(),
        on_warning=lambda sentence: _say(f"warning: {sentence}"),
    )
    settings = replace(settings, capture=capture.settings)
    pipeline: Pipeline = Pipeline(settings)
    result = ReplayResult()
    _scan(capture, pipeline, result)
    _conclude(capture, pipeline, result)
    _report(capture, result)
    if options.json is not None:
        write_json(options.json, replay_record(capture, settings, result))
        print(f"wrote {options.json}")
    if options.materials is not None and result.materials is not None:
        export_materials(result.materials, options.materials)
        print(f"wrote {options.materials}")
    if options.save_scan is not None and result.fused_count:
        pipeline.save(options.save_scan)
        print(f"wrote {options.save_scan}")
    if options.report is not None and result.materials is not None:
        write_report(options.report, capture, pipeline, result)
        print(f"wrote {options.report}")
    if light_kind and result.fused_count:
        export_environment(pipeline.snapshot().surface, light_kind, options.environment)
        print(f"wrote {options.environment}")
    if result.final is None:
        raise CaptureError(f"{capture.name} gives no estimate: {result.no_final}")


def _check_no_scan(path: Path) -> None:
    """Refuse a saved scan, which has no images to replay, and name what takes it."""
    with suppress(OSError, ValueError):  # then it is no scan, and opening it says what is wrong
        if is_saved(path) and is_scan_file(path):
            raise CaptureError(
                f"{path} is a saved scan, which has no images to replay: `reflest view {path}` "
                f"shows it, `reflest export {path}` writes its surface or light"
            )


def _scan(capture: Capture, pipeline: Pipeline, result: ReplayResult) -> None:
    """Fuse every frame and estimate at every keyframe."""
    with tqdm(total=capture.frame_total, unit="frame", disable=None) as bar:
        for frame in capture:
            bar.update(capture.frames_seen - bar.n)
            try:
                scanned = pipeline.fuse(frame)
            except FrameRefused as refusal:
                capture.refuse(refusal)
                continue
            result.fused_count += 1
            result.redundant_count += scanned.fused.is_redundant
            result.light_count += scanned.fused.is_light_alone
            result.last_fused = frame
            if scanned.keyframe is None:
                continue
            try:
                estimate = pipeline.estimate(scanned.keyframe)
            except NoEstimate as reason:
                tqdm.write(f"{frame.stamp_ns / 1e9:.3f} s  no estimate: {reason}")
                continue
            result.estimates.append(estimate)
            tqdm.write(estimate_line(estimate))
        bar.update(capture.frames_seen - bar.n)


def _conclude(capture: Capture, pipeline: Pipeline, result: ReplayResult) -> None:
    """Estimate from the whole scan, or note why that cannot be done."""
    result.poses = pipeline.poses.report
    frame = result.last_fused
    if frame is None:
        reasons = "; ".join(capture.refusals.first_message.values())
        result.no_final = reasons or "it holds no colour image"
        return
    try:
        snapshot = pipeline.snapshot()
        result.final = pipeline.estimate(snapshot)
        result.materials = pipeline.final_materials()
        estimated = snapshot.surface if snapshot.around is None else snapshot.around
        if estimated.voxel_count < (snapshot.voxel_count or 0):
            result.thinned_to = estimated.voxel_count
        if snapshot.middle is not None and len(result.materials.materials) > 1:
            found = result.materials.near(snapshot.middle)
            result.middle_id = None if found is None else found.id
    except NoEstimate as reason:
        result.no_final = str(reason)


def _report(capture: Capture, result: ReplayResult) -> None:
    notes = {"redundant": result.redundant_count, "of the light alone": result.light_count}
    counts = "".join(f", {count} of them {what}" for what, count in notes.items() if count)
    print(f"{capture.frames_seen} colour images, {result.fused_count} frames fused{counts}")
    for line in (
        final_lines(result.final, result.middle_id, result.thinned_to) if result.final else []
    ):
        print(line)
    for line in material_lines(result.materials, sys.stdout.isatty()) if result.materials else []:
        print(line)
    if refused := refusals_line(capture):
        _say(refused)
    for warning in filter(None, (result.poses.warning, capture.damage)):
        _say(f"warning: {warning}")


def _warn_of_refusal(refusal: FrameRefused, is_first: bool) -> None:
    if is_first:
        _say(f"warning: {refusal} (counted as {refusal.cause.value}; said once)")


def _say(sentence: str) -> None:
    tqdm.write(f"reflest: {sentence}", file=sys.stderr)
