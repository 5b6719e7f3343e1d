# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sections: Figure 6, and light beyond what the scan shows."""

from __future__ import annotations

from reflest_core.evaluation.sections.markdown import Lines, Record, interval, table


def views(record: Record) -> Lines:
    """Section: error against the number of views, split by split.

    Args:
        record: Result of :func:`.measure_views`.
    """
    header = ["network", *(f"{count} views" for count in record["views"])]
    lines = [
        "## Figure 6: error against the number of views",
        "",
        "![Error against views](views.png)",
        "",
        "RMSE where only so many random views of a scene are used, for the surface and for the",
        "light behind it. The paper's figure has no numbers; its text puts the effective amount",
        "around 30 views.",
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


def look_around(record: Record) -> Lines:
    """Section: error where more of the light is known than the scan shows.

    Args:
        record: Result of :func:`.measure_look_around`.
    """
    body = []
    for row in record["rows"]:
        scan, looked, known, rooms = (row[key] for key in ("scan", "with", "panorama", "rooms"))
        body.append(
            [
                row["split"],
                row["views"],
                row["pattern"],
                scan["scenes"],
                f"{scan['seen']:.0%}",
                scan["ward"]["overall"],
                f"{looked['seen']:.0%}",
                looked["ward"]["overall"],
                interval(looked["over_environments"]),
                f"{row['recognised']:.1%}",
                rooms["ward"]["overall"],
                interval(rooms["over_environments"]),
                known["ward"]["overall"],
                interval(known["over_environments"]),
            ]
        )
    header = [
        "split",
        "views",
        "their pattern",
        "scenes",
        "light seen",
        "RMSE",
        "light seen, look round",
        "RMSE, look round",
        "95 %, environments",
        "recognised",
        "RMSE, rooms",
        "95 %, environments",
        "RMSE, panorama",
        "95 %, environments",
    ]
    return [
        "## Light beyond the scan",
        "",
        "lightnet on all scenes with four states of knowledge about the light:",
        "",
        "- the scan alone, as in all other tables;",
        f"- *look round*: {record['frames']} more frames of the upper half of the surroundings, by",
        "  the same camera at the same exposure (live, such frames add to the light);",
        f"- *rooms*: a folder of {record['rooms']} panoramas of the training environments as",
        "  `estimation.known_light`. The scan's own room and its orientation have to be",
        "  *recognised* (validation scenes stand in these rooms, *unseen* ones in none of them);",
        "- *panorama*: a panorama of the scan's room, in its axes, as `estimation.known_light`.",
        "",
        *table(header, body),
        "",
    ]


def _few(few: Record) -> Lines:
    body = [
        [
            split,
            of["scenes"],
            of["ward"]["overall"],
            interval(of["over_scenes"]),
            interval(of["over_environments"]),
            of["ward"]["scene_mean"],
        ]
        for split, of in few["accuracy"].items()
    ]
    header = ["split", "scenes", "RMSE", "95 %, scenes", "95 %, environments", "scene mean"]
    return [
        f"lightnet at {few['views']} views of every scene:",
        "",
        *table(header, body),
        "",
    ]
