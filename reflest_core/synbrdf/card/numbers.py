# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The data card's table."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from reflest_core.synbrdf.card.summary import SceneSummary

ROWS: dict[str, tuple[Callable[[SceneSummary], float], str]] = {
    "diffuse albedo (luminance)": (lambda scene: scene.luminance, ".3f"),
    "rho_s": (lambda scene: scene.rho_s, ".3f"),
    "alpha": (lambda scene: scene.alpha, ".3f"),
    "contrast c": (lambda scene: scene.contrast, ".3f"),
    "diameter (m)": (lambda scene: scene.diameter, ".2f"),
    "distance (m)": (lambda scene: scene.distance, ".2f"),
    "observations a point, of all views": (lambda scene: scene.observations, ".1f"),
    "share of a view's pixels on the object (%)": (lambda scene: 100 * scene.on_object, ".1f"),
    "clipped observations (%)": (lambda scene: 100 * scene.clipped, ".2f"),
}
QUANTILES = (0.05, 0.5, 0.95)


def table(scenes: list[SceneSummary]) -> str:
    """Markdown: mean, quantiles and extremes of each figure, for each split.

    Args:
        scenes: of the data set.
    """
    lines = [
        "| split | figure | mean | 5 % | median | 95 % | most |",
        "|---|---|---|---|---|---|---|",
    ]
    for split in dict.fromkeys(scene.split for scene in scenes):
        chosen = [scene for scene in scenes if scene.split == split]
        for name, (figure, form) in ROWS.items():
            values = np.array([figure(scene) for scene in chosen])
            cells = [values.mean(), *np.quantile(values, QUANTILES), values.max()]
            numbers = " | ".join(format(float(cell), form) for cell in cells)
            lines.append(f"| {split} ({len(chosen)} scenes) | {name} | {numbers} |")
    return "\n".join(lines) + "\n"


def clipping(scenes: list[SceneSummary], worst: int = 5) -> str:
    """Markdown: how many scenes clip a lot, and the worst.

    Args:
        scenes: of the data set.
        worst: scenes to name.
    """
    order = sorted(scenes, key=lambda scene: -scene.clipped)
    shares = [
        f"more than {limit} % of observations clip in "
        f"{100 * np.mean([scene.clipped > limit / 100 for scene in scenes]):.1f} % of the scenes"
        for limit in (1, 5, 10)
    ]
    names = ", ".join(
        f"{100 * scene.clipped:.0f} % ({scene.environment}, {scene.shape})"
        for scene in order[:worst]
    )
    return "; ".join(shares) + f". The worst: {names}.\n"
