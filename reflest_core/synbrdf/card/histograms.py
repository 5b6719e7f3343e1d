# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Histograms of what the scenes of a set were drawn as."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.brdf import srgb
from reflest_core.synbrdf.card.summary import SceneSummary

BAR = "#4878a8"


def draw_materials(scenes: list[SceneSummary], path: Path) -> None:
    """Diffuse colours, and histograms of the Ward parameters and of contrast.

    Args:
        scenes: of the data set.
        path: the file.
    """
    figure, axes = _figure(2, 3)
    rho_d = np.array([scene.rho_d for scene in scenes])
    lightness = np.array([scene.luminance for scene in scenes])
    _histogram(axes[0, 0], lightness, "diffuse albedo (luminance of rho_d)")
    _histogram(axes[0, 1], [scene.rho_s for scene in scenes], "specular albedo rho_s")
    _histogram(axes[0, 2], [scene.alpha for scene in scenes], "roughness alpha")
    _histogram(axes[1, 0], [scene.contrast for scene in scenes], "contrast of gloss c")
    _scatter(axes[1, 1], rho_d, [s.alpha for s in scenes], [s.rho_s for s in scenes])
    axes[1, 1].set(xlabel="roughness alpha", ylabel="rho_s", title="in their diffuse colours")
    _scatter(axes[1, 2], rho_d, rho_d[:, 0] - rho_d[:, 1], rho_d[:, 2] - rho_d[:, 1])
    axes[1, 2].set(xlabel="red - green", ylabel="blue - green", title="diffuse colours")
    figure.savefig(path)


def draw_captures(scenes: list[SceneSummary], path: Path) -> None:
    """Shapes, light, views, and what they lead to.

    Args:
        scenes: of the data set.
        path: the file.
    """
    figure, axes = _figure(2, 4)
    kinds = Counter(scene.shape for scene in scenes)
    procedural = ("blob", "superquadric", "lathe", "sweep", "csg")
    from_files = sum(count for shape, count in kinds.items() if shape not in procedural)
    _bars(axes[0, 0], {**{k: kinds[k] for k in procedural}, "mesh files": from_files}, "shape")
    patterns = Counter(scene.view_pattern for scene in scenes)
    _bars(axes[0, 1], dict(sorted(patterns.items())), "view pattern")
    _histogram(axes[0, 2], [scene.diameter for scene in scenes], "diameter (m)")
    _histogram(axes[0, 3], [scene.distance for scene in scenes], "mean distance (m)")
    _histogram(axes[1, 0], np.log2([s.exposure for s in scenes]), "exposure (stops)")
    _histogram(axes[1, 1], [scene.observations for scene in scenes], "observations a point")
    _histogram(axes[1, 2], [100 * s.clipped for s in scenes], "clipped observations (%)")
    axes[1, 2].set_yscale("log")
    light = Counter(name for scene in scenes for name in scene.environment.split("+"))
    _histogram(axes[1, 3], list(light.values()), "scenes that it lights", "environments", 20)
    figure.savefig(path)


def _figure(rows: int, columns: int) -> tuple[Any, Any]:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    return plt.subplots(
        rows, columns, figsize=(3.2 * columns, 2.6 * rows), layout="constrained", dpi=100
    )


def _histogram(axis: Any, values: Any, label: str, of: str = "scenes", bins: int = 40) -> None:
    axis.hist(np.asarray(values, dtype=float), bins=bins, color=BAR)
    axis.set(xlabel=label, ylabel=of)


def _bars(axis: Any, counts: dict[str, int], label: str) -> None:
    axis.barh(list(counts), list(counts.values()), color=BAR)
    axis.invert_yaxis()
    axis.set(xlabel="scenes", title=label)


def _scatter(axis: Any, rho_d: Any, x: Any, y: Any) -> None:
    axis.scatter(x, y, s=4, color=np.clip(srgb.encode(rho_d), 0, 1))
    axis.set_facecolor("#dddddd")
