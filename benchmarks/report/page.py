# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Writes results as JSON, page and plots, and updates the short table in docs/performance.md."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from benchmarks.report.growth_section import growth_section
from benchmarks.report.plots import plot_estimates, plot_frames
from benchmarks.report.run_sections import (
    live_section,
    machine_section,
    memory_section,
    start_up_section,
    targets_section,
)
from benchmarks.report.stage_sections import (
    estimation_section,
    open3d_section,
    stages_section,
)
from reflest_core.cli.output_files import write_json
from reflest_core.errors import ReflestError

BEGIN, END = "<!-- written by make bench -->", "<!-- end of what make bench writes -->"
FRAMES_PLOT, ESTIMATES_PLOT = "performance-frames.png", "performance-estimates.png"


class GuideDamaged(ReflestError):
    """docs/performance.md lacks the two marks around the table."""


def write_page(results: dict[str, Any], docs: Path) -> Path:
    """Write results and images below ``docs``, and the targets in ``docs/performance.md``.

    Args:
        results: Result of :func:`benchmarks.run.run`.
        docs: The documentation's folder.

    Returns:
        The path of the page.

    Raises:
        GuideDamaged: docs/performance.md lacks the marks.
    """
    for folder in (docs / "results", docs / "images"):
        folder.mkdir(parents=True, exist_ok=True)
    write_json(docs / "results" / "performance.json", results)
    plot_frames(results, docs / "images" / FRAMES_PLOT)
    plot_estimates(results, docs / "images" / ESTIMATES_PLOT)
    page = docs / "results" / "performance.md"
    page.write_text(page_text(results))
    guide = docs / "performance.md"
    if guide.exists():
        guide.write_text(_renewed(guide.read_text(), results))
    return page


def page_text(results: dict[str, Any]) -> str:
    """The page in Markdown.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    parts = [
        "# Performance, as measured",
        "Written by `make bench` (`python -m benchmarks`); the same figures in full are in "
        "[performance.json](performance.json), and what to make of them in "
        "[the guide](../performance.md). Milliseconds unless named otherwise.",
        machine_section(results),
        "## Targets",
        targets_section(results),
        "## Stages of the live path",
        stages_section(results),
        "## Open3D's VoxelBlockGrid on the same frames",
        open3d_section(results),
        "## Estimates",
        estimation_section(results),
        "## Growth",
        f"![cost of a frame](../images/{FRAMES_PLOT})",
        f"![cost of an estimate](../images/{ESTIMATES_PLOT})",
        growth_section(results),
        "## The node at camera speed",
        live_section(results),
        "## Memory",
        memory_section(results),
        "## Start-up and replay",
        start_up_section(results),
    ]
    for capture in (results[key] for key in ("scene", "capture") if key in results):
        as_threads = {name: {"2": capture[name]} for name in ("frame_path", "against_open3d")}
        as_threads["open3d"] = {"2": capture["open3d"]}
        parts += [
            f"## Frames of {capture['name']}, no region of interest",
            stages_section(as_threads),
            open3d_section(as_threads),
        ]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"


def _renewed(guide: str, results: dict[str, Any]) -> str:
    if BEGIN not in guide or END not in guide:
        raise GuideDamaged(
            f"docs/performance.md has lost its marks {BEGIN} and {END}: restore them"
        )
    figures = f"{BEGIN}\n\n{targets_section(results)}\n"
    figures += f"Measured on: {machine_section(results)}\n{END}"
    return re.sub(
        f"{re.escape(BEGIN)}.*{re.escape(END)}", lambda _: figures, guide, flags=re.DOTALL
    )
