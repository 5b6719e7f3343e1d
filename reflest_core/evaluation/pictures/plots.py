# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The plots of the results page, from its records."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.paper_figures import USEFUL_VIEWS
from reflest_core.models.card import WARD_NAMES

PANELS = (("rho_d (r, g, b)", (0, 1, 2)), ("rho_s", (3,)), ("alpha", (4,)))
CHANNEL_COLOURS = ("#c23b3b", "#3b8f3b", "#3b5fc2")
PARAMETERS = (*CHANNEL_COLOURS, "0.2", "#b565c9")
CURVES = {
    "HemiCNN": "#3b5fc2",
    "Grouplet-fast": "#c23b3b",
    "Grouplet-slow": "#e08b2d",
    "lightnet": "#1f7a4d",
}
"""The colours of the paper's Figure 6, and one for lightnet."""


def new_figure(width: float, height: float) -> Any:
    """An empty matplotlib figure.

    Args:
        width: Inches.
        height: Inches.

    Raises:
        EvaluationError: matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise EvaluationError(
            "plots need matplotlib: pip install 'reflest-ros[training]'"
        ) from error
    return Figure(figsize=(width, height), layout="constrained")


def draw_views(path: Path, record: dict[str, Any]) -> None:
    """Draw Figure 6: a panel for each split, a curve for each network.

    Args:
        path: The PNG to write.
        record: Result of :func:`.measure_views`.
    """
    figure = new_figure(8.6, 3.6)
    panels = figure.subplots(1, len(record["scenes"]), sharey=True, squeeze=False)[0]
    top = 1.1 * max(max(curve["rmse"]) for curve in record["curves"])
    for axes, split in zip(panels, record["scenes"], strict=True):
        for curve in record["curves"]:
            if curve["split"] == split:
                name = curve["network"]
                axes.plot(record["views"], curve["rmse"], "o-", label=name, color=CURVES[name])
        axes.axvline(USEFUL_VIEWS, color="0.8", linewidth=1, zorder=0)
        axes.set(xlabel="views", title=split, ylim=(0, top))
    panels[0].set_ylabel("normalised RMSE")
    panels[-1].legend(frameon=False)
    figure.savefig(path, dpi=110)


def draw_reliability(path: Path, record: dict[str, Any]) -> None:
    """Draw stated against observed coverage of every parameter, a panel for each split.

    Args:
        path: The PNG to write.
        record: Result of :func:`.measure_calibration` by split, under ``splits``.
    """
    figure = new_figure(8.6, 4.0)
    panels = figure.subplots(1, len(record["splits"]), sharey=True, squeeze=False)[0]
    for axes, (split, of) in zip(panels, record["splits"].items(), strict=True):
        axes.plot([0, 1], [0, 1], color="0.7", linewidth=1)
        observed = np.array(of["observed"])
        for column, (name, colour) in enumerate(zip(WARD_NAMES, PARAMETERS, strict=True)):
            axes.plot(of["levels"], observed[:, column], "o-", ms=3, label=name, color=colour)
        axes.set(xlabel="stated probability", title=split, xlim=(0, 1), ylim=(0, 1))
    panels[0].set_ylabel("share of truths inside")
    panels[-1].legend(frameon=False, loc="lower right")
    figure.savefig(path, dpi=100)


def draw_accuracy(path: Path, record: dict[str, Any]) -> None:
    """Draw every network's RMSE on each split with its interval, and the paper's.

    Args:
        path: The PNG to write.
        record: The record of Table 2.
    """
    rows = record["rows"]
    titles = list(dict.fromkeys(row["title"] for row in rows))
    figure = new_figure(7.2, 0.5 * len(titles) + 1.4)
    axes = figure.subplots()
    for offset, (split, colour) in enumerate((("validation", "#3b5fc2"), ("unseen", "#e08b2d"))):
        of = [row for row in rows if row["split"] == split]
        places = np.array([titles.index(row["title"]) for row in of]) + 0.2 * offset - 0.1
        overall = np.array([row["accuracy"]["ward"]["overall"] for row in of])
        bounds = [row["accuracy"]["over_environments"] for row in of]
        reach = (
            np.array(
                [[overall[k] - b["low"], b["high"] - overall[k]] for k, b in enumerate(bounds)]
            )
            .reshape(-1, 2)
            .T
        )
        axes.errorbar(overall, places, xerr=np.abs(reach), fmt="o", label=split, color=colour)
        if split == "validation":
            theirs = [
                (row["paper_rmse"], place)
                for row, place in zip(of, places, strict=True)
                if row["paper_rmse"] is not None
            ]
            errors, rows_of = [error for error, _ in theirs], [place for _, place in theirs]
            axes.plot(errors, rows_of, "x", color="0.3", label="paper (its validation)")
    axes.set_yticks(range(len(titles)), titles)
    axes.invert_yaxis()
    axes.set(xlabel="normalised RMSE, 95 % over environments", xlim=(0, None))
    axes.legend(frameon=False)
    figure.savefig(path, dpi=110)


def draw_scatter(path: Path, estimates: dict[str, Any], network: str) -> None:
    """Draw estimates against truths on each split.

    Args:
        path: The PNG to write.
        estimates: Result of :func:`.as_figures`.
        network: The network's name.
    """
    splits = ("validation", "unseen")
    figure = new_figure(11, 3.4 * len(splits))
    figure.suptitle(network)
    axes = figure.subplots(len(splits), len(PANELS), squeeze=False)
    for row, split in enumerate(splits):
        truths = np.array(estimates[split]["truths"])
        made = np.array(estimates[split]["networks"][network]["ward"])
        for column, (name, indices) in enumerate(PANELS):
            panel = axes[row, column]
            top = float(truths[:, indices].max())
            panel.plot([0, top], [0, top], color="0.7", linewidth=1)
            for index in indices:
                colour = CHANNEL_COLOURS[index] if index < 3 else "0.2"
                panel.scatter(truths[:, index], made[:, index], s=7, color=colour, alpha=0.6)
            panel.set(xlabel="truth", ylabel="estimate", title=f"{name}, {split}")
    figure.savefig(path, dpi=90)
