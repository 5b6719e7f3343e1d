# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Plots of how time grows with size."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from benchmarks.measurements.open3d_grid import INTEGRATE

FRAME_TIME_MS = 1000.0 / 30.0
COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:red", "tab:purple", "tab:brown")


def plot_frames(results: dict[str, Any], path: Path) -> None:
    """Draw the time of a frame by voxel size, resolution and region; each frame is a new view.

    Args:
        results: Result of :func:`benchmarks.run.run`.
        path: The PNG to write.
    """
    growth = results["growth_of_fusion"]
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.8), sharey=True)
    panels = (
        ("voxel size", [f"{one['voxel_size_mm']:g} mm" for one in growth["voxel_size"]]),
        ("resolution", [f"{one['width']} x {one['height']}" for one in growth["resolution"]]),
        ("region", [one["region"].replace(" (", "\n(") for one in growth["region"]]),
    )
    for axis, (title, labels) in zip(axes, panels, strict=True):
        timings = [one["fuse"] for one in growth[title.replace(" ", "_")]]
        places = list(range(len(labels)))
        medians, tails = [one["p50_ms"] for one in timings], [one["p95_ms"] for one in timings]
        axis.vlines(places, medians, tails, color="tab:blue")
        axis.plot(places, tails, "_", color="tab:blue", markersize=12, label="reflest, p95")
        axis.plot(places, medians, "o", color="tab:blue", label="reflest, median")
        for place, median in zip(places, medians, strict=True):
            axis.annotate(f"{median:.3g}", (place, median), (8, -4), textcoords="offset points")
        axis.axhline(FRAME_TIME_MS, color="black", linewidth=0.8, linestyle=":", label="30 Hz")
        axis.axhline(
            _open3d_ms(results),
            color="tab:red",
            linewidth=0.8,
            linestyle="--",
            label="Open3D with colour, 5 mm, no region",
        )
        axis.set_xticks(places, labels)
        axis.set_xlim(-0.5, len(labels) - 0.3)
        axis.set_title(f"by {title}")
        axis.set_yscale("log")
        axis.grid(axis="y", alpha=0.3)
        _plain_numbers(axis)
    axes[0].set_ylabel("fusion of one frame (ms)")
    axes[0].legend(loc="best", fontsize="small")
    _finish(figure, path)


def _open3d_ms(results: dict[str, Any]) -> float:
    """Median of the peer's integration, with as many threads as growth was measured with."""
    most = max(results["open3d"], key=int)
    stages = results["open3d"][most]["colour"]["stages"]
    return float(next(one["p50_ms"] for one in stages if one["name"] == INTEGRATE))


def plot_estimates(results: dict[str, Any], path: Path) -> None:
    """Draw the time of an estimate, a snapshot and a frame against the size of the scan.

    Args:
        results: Result of :func:`benchmarks.run.run`.
        path: The PNG to write.
    """
    growth = results["growth_of_estimates"]
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.2), sharey=True)
    _lines(left, growth["store"], "voxels", "surface voxels in the store")
    _lines(right, growth["views"], "views", "views of the object")
    left.set_ylabel("median (ms)")
    left.set_title("a larger surface (a floor)")
    right.set_title("more views (the object on the table)")
    right.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize="small")
    _finish(figure, path)


def _lines(axis: Axes, scans: list[dict[str, Any]], x: str, label: str) -> None:
    for number, one in enumerate(scans[0]["timings"]):
        name = one["name"]
        medians = [scan["timings"][number]["p50_ms"] for scan in scans]
        name = "fuse a frame" if name == "fuse" else name
        axis.plot(
            [scan[x] for scan in scans], medians, marker="o", label=name, color=COLOURS[number]
        )
    axis.set_xscale("log")
    axis.set_yscale("log")
    _plain_numbers(axis)
    axis.set_xlabel(label)
    axis.grid(alpha=0.3)


def _plain_numbers(axis: Axes) -> None:
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.yaxis.set_minor_formatter(NullFormatter())


def _finish(figure: Figure, path: Path) -> None:
    figure.tight_layout()
    figure.savefig(path, dpi=110, metadata={"Software": None})
    plt.close(figure)
