# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Figure 6."""

from __future__ import annotations

from reflest_core.evaluation.markdown import table
from reflest_core.evaluation.sections.cells import Lines, Record, interval


def views(record: Record) -> Lines:
    """Error against the number of views, split by split."""
    header = ["network", *(f"{count} views" for count in record["views"])]
    lines = [
        "## Figure 6: error against the number of views",
        "",
        "![Error against views](views.png)",
        "",
        "RMSE on scenes of which only so many random views are shown: neither the surface nor the",
        "light behind it is known from any other. The paper's figure has no numbers; it puts the",
        "effective amount around 30 views.",
        "",
    ]
    for split, scenes in record["scenes"].items():
        curves = [curve for curve in record["curves"] if curve["split"] == split]
        lines += [
            f"{split.capitalize()}, {scenes} scenes drawn by seed:",
            "",
            *table(header, [[curve["network"], *curve["rmse"]] for curve in curves]),
            "",
        ]
    return lines + (_few(record["few"]) if record["few"] else [])


def _few(few: Record) -> Lines:
    body = [
        [
            split, of["scenes"], of["ward"]["overall"], interval(of["over_scenes"]),
            interval(of["over_environments"]), of["ward"]["scene_mean"],
        ]
        for split, of in few["accuracy"].items()
    ]  # fmt: skip
    header = ["split", "scenes", "RMSE", "95 %, scenes", "95 %, environments", "scene mean"]
    return [
        f"lightnet at {few['views']} views of every scene:",
        "",
        *table(header, body),
        "",
    ]
