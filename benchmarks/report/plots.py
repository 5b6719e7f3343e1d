"""Plots of how cost grows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

FRAME_TIME_MS = 1000.0 / 30.0
COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:red", "tab:purple")


def plot_frames(results: dict[str, Any], path: Path) -> None:
    """What a frame costs by voxel size, resolution and region; each frame is a new view."""
    growth = results["growth_of_fusion"]
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.6), sharey=True)
    panels = (
        ("voxel size", [f"{one['voxel_size_mm']:g} mm" for one in growth["voxel_size"]]),
        ("resolution", [f"{one['width']} x {one['height']}" for one in growth["resolution"]]),
        ("region", [one["region"].replace(" (", "\n(") for one in growth["region"]]),
    )
    for axis, (title, labels) in zip(axes, panels, strict=True):
        timings = [one["fuse"] for one in growth[title.replace(" ", "_")]]
        places = range(len(labels))
        axis.bar(places, [one["p95_ms"] for one in timings], color="lightsteelblue", label="p95")
        axis.bar(places, [one["p50_ms"] for one in timings], color="steelblue", label="median")
        axis.axhline(FRAME_TIME_MS, color="black", linewidth=0.8, linestyle=":")
        for place, one in zip(places, timings, strict=True):
            axis.text(place, one["p95_ms"], f" {one['p50_ms']:.0f} ms", ha="center", va="bottom")
        axis.set_xticks(list(places), labels)
        axis.set_title(f"by {title}")
        axis.set_yscale("log")
        axis.margins(y=0.15)
    axes[0].set_ylabel("fusion of one frame (ms)")
    axes[0].legend(loc="upper left", fontsize="small")
    axes[2].text(-0.45, FRAME_TIME_MS * 1.05, "30 frames a second", fontsize="small")
    _finish(figure, path)


def plot_estimates(results: dict[str, Any], path: Path) -> None:
    """What an estimate, a snapshot and a frame cost as the scan grows: all should be level."""
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
    axis.set_xlabel(label)
    axis.grid(alpha=0.3)


def _finish(figure: Figure, path: Path) -> None:
    figure.tight_layout()
    figure.savefig(path, dpi=110, metadata={"Software": None})
    plt.close(figure)
