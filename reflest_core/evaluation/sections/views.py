# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Figure 6."""

from __future__ import annotations

from reflest_core.evaluation.sections.cells import Lines, Record, interval
from reflest_core.evaluation.sections.markdown import table


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


def look_around(record: Record) -> Lines:
    """What it buys to know more of the light than the scans show."""
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
        "light seen, look",
        "RMSE, look",
        "95 %, environments",
        "told",
        "RMSE, rooms",
        "95 %, environments",
        "RMSE, panorama",
        "95 %, environments",
    ]
    return [
        "## What a look around the room buys",
        "",
        f"lightnet on all scenes, as scanned; with {record['frames']} further frames that look",
        "away from the object, at the upper half of its surroundings, through the same camera at",
        "the same exposure (live, such frames are taken for their light); with a folder of",
        f"{record['rooms']} rooms, panoramas of the environments that training scenes stand in,",
        "among which the scan's own has to be *told* by what it sees, and how it is turned",
        "(validation has these rooms, *unseen* has none of them); and with a panorama of the very",
        "room in its own axes. A user gives either as `estimation.known_light`. Other tables are",
        "of the scans alone.",
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
