# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Plots beside the page's tables, from the same records."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.evaluation.contenders import EvaluationError

PANELS = (("rho_d (r, g, b)", (0, 1, 2)), ("rho_s", (3,)), ("alpha", (4,)))
CHANNEL_COLOURS = ("#c23b3b", "#3b8f3b", "#3b5fc2")
CURVES = {"HemiCNN": "#3b5fc2", "Grouplet-fast": "#c23b3b", "Grouplet-slow": "#e08b2d"}
"""The colours of the paper's Figure 6."""


def _new_figure(width: float, height: float) -> Any:
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise EvaluationError("plots need matplotlib: pip install matplotlib") from error
    return Figure(figsize=(width, height), layout="constrained")


def draw_views(path: Path, record: dict[str, Any]) -> None:
    """Figure 6: one curve for each network."""
    figure = _new_figure(6.4, 3.6)
    axes = figure.subplots()
    for curve in record["curves"]:
        colour = CURVES[curve["network"]]
        axes.plot(record["views"], curve["rmse"], "o-", label=curve["network"], color=colour)
    axes.axvline(30, color="0.8", linewidth=1, zorder=0)
    top = 1.1 * max(max(curve["rmse"]) for curve in record["curves"])
    axes.set(xlabel="views", ylabel="normalised RMSE, validation", ylim=(0, top))
    axes.legend(frameon=False)
    figure.savefig(path, dpi=110)


def draw_accuracy(path: Path, record: dict[str, Any]) -> None:
    """Every variant's RMSE on each split with its interval, beside the paper's figure."""
    rows = record["rows"]
    titles = list(dict.fromkeys(row["title"] for row in rows))
    figure = _new_figure(7.2, 0.5 * len(titles) + 1.4)
    axes = figure.subplots()
    for offset, (split, colour) in enumerate((("validation", "#3b5fc2"), ("unseen", "#e08b2d"))):
        of = [row for row in rows if row["split"] == split]
        places = np.array([titles.index(row["title"]) for row in of]) + 0.2 * offset - 0.1
        overall = np.array([row["accuracy"]["ward"]["overall"] for row in of])
        bounds = [row["accuracy"]["over_environments"] for row in of]
        reach = np.array([[overall[k] - b["low"], b["high"] - overall[k]]
                          for k, b in enumerate(bounds)]).reshape(-1, 2).T  # fmt: skip
        axes.errorbar(overall, places, xerr=np.abs(reach), fmt="o", label=split, color=colour)
        if split == "validation":
            paper = [row["paper_rmse"] for row in of]
            axes.plot(paper, places, "x", color="0.3", label="paper (its validation)")
    axes.set_yticks(range(len(titles)), titles)
    axes.invert_yaxis()
    axes.set(xlabel="normalised RMSE, 95 % over environments", xlim=(0, None))
    axes.legend(frameon=False)
    figure.savefig(path, dpi=110)


def draw_scatter(path: Path, estimates: dict[str, Any], variant: str) -> None:
    """Estimates of ``variant`` against truths on each split; the diagonal is perfect."""
    splits = ("validation", "unseen")
    figure = _new_figure(11, 3.4 * len(splits))
    figure.suptitle(variant)
    axes = figure.subplots(len(splits), len(PANELS), squeeze=False)
    for row, split in enumerate(splits):
        truths = np.array(estimates[f"{split}_truths"])
        made = np.array(estimates[split][variant])
        for column, (name, indices) in enumerate(PANELS):
            panel = axes[row, column]
            top = float(truths[:, indices].max())
            panel.plot([0, top], [0, top], color="0.7", linewidth=1)
            for index in indices:
                colour = CHANNEL_COLOURS[index] if index < 3 else "0.2"
                panel.scatter(truths[:, index], made[:, index], s=7, color=colour, alpha=0.6)
            panel.set(xlabel="truth", ylabel="estimate", title=f"{name}, {split}")
    figure.savefig(path, dpi=90)
