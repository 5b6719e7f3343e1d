# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Section: lightnet under every training environment, by trainings without it."""

from __future__ import annotations

from reflest_core.evaluation.sections.markdown import Lines, Record, interval, percent, table
from reflest_core.models.card import WARD_NAMES


def held_out_lights(record: Record) -> Lines:
    """Section: errors by views and by environment, and shares of truths in the stated intervals.

    Args:
        record: Result of :func:`.measure_held_out_lights`.
    """
    views = record["views"]
    most = views[max(views, key=int)]
    return [
        "## Held-out training environments",
        "",
        "The *unseen* split has few environments. So lightnet was also trained",
        f"{record['trainings']} times by one recipe, each time without some of the "
        f"{record['lights']} training",
        "environments (in mixtures, relit scenes and windows too), and measured on the training",
        "scenes under these. The shipped weights' deviations are calibrated on all of these",
        "errors; here the intervals of each training are calibrated on the other trainings.",
        "",
        *table(
            [
                "views",
                "variants",
                "RMSE",
                "95 %, environments",
                "mean of five",
                "95 %, environments",
                "scene mean",
                *WARD_NAMES,
            ],
            [
                [
                    int(count),
                    of["variants"],
                    of["rmse"],
                    interval(of["over_environments"]),
                    of["mean_of_parameters"],
                    interval(of["mean_over_environments"]),
                    of["scene_mean"],
                    *of["per_parameter"],
                ]
                for count, of in views.items()
            ],
        ),
        "",
        "Share of truths in 90 % intervals; for the most views also in four equal groups by the",
        "stated deviation, the smallest first:",
        "",
        *table(
            ["views", *WARD_NAMES],
            [[count, *map(percent, of["inside"])] for count, of in views.items()]
            + [
                [f"{max(views, key=int)}, quarter {number}", *map(percent, quarter)]
                for number, quarter in enumerate(
                    zip(*most["inside_by_quarter"], strict=True), start=1
                )
            ],
        ),
        "",
        f"RMSE of {max(views, key=int)} views under each light: "
        + ", ".join(f"{light} {error:.2f}" for light, error in most["by_light"].items())
        + ".",
        "",
    ]
