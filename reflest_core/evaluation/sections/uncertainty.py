# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sections: the stated uncertainty, how far estimates move, and the worst estimates."""

from __future__ import annotations

from reflest_core.evaluation.sections.markdown import Lines, Record, percent, table
from reflest_core.models.card import WARD_NAMES


def calibration(record: Record) -> Lines:
    """Section: intervals, standard deviations and statuses against the errors made.

    Args:
        record: Result of :func:`.measure_calibration` by split, under ``splits``.
    """
    splits = record["splits"]
    return [
        "## Calibration of the stated uncertainty",
        "",
        "![Reliability](calibration.png)",
        "",
        "lightnet states a standard deviation of every parameter. Shares of truths within 90 %",
        "intervals (estimate +- 1.645 standard deviations), in brackets 95 % over environments:",
        "",
        *table(["split", *WARD_NAMES], [_inside(split, of) for split, of in splits.items()]),
        "",
        "Standard deviation of (estimate - truth) / stated deviation; 1 is ideal:",
        "",
        *table(
            ["split", *WARD_NAMES],
            [[split, *map(float, of["z_stddev"])] for split, of in splits.items()],
        ),
        "",
        "Scenes in four equal groups by the stated error, with the actual error:",
        "",
        *table(
            ["split", "quarter", "scenes", "stated", "RMSE"],
            [
                [split, number, group["scenes"], group["expected"], group["rmse"]]
                for split, of in splits.items()
                for number, group in enumerate(of["quartiles"], start=1)
            ],
        ),
        "",
        "Share of each status after all of a scene's views, and the error of these scenes:",
        "",
        *table(
            ["split", "status", "scenes", "share", "RMSE", *WARD_NAMES],
            [_status(split, row) for split, of in splits.items() for row in of["statuses"]],
        ),
        "",
    ]


def _inside(split: str, of: Record) -> list[str]:
    cells = [
        f"{percent(share)} ({100 * around['low']:.0f} to {100 * around['high']:.0f})"
        for share, around in zip(of["inside"], of["inside_intervals"], strict=True)
    ]
    return [split, *cells]


def _status(split: str, row: Record) -> list[object]:
    per_parameter = row["per_parameter"] or [None] * len(WARD_NAMES)
    share = percent(row["share"])
    return [split, row["status"], row["scenes"], share, row["rmse"], *per_parameter]


def stability(record: Record) -> Lines:
    """Section: movements of the estimate in units of its stated standard deviation.

    Args:
        record: Result of :func:`.measure_stability`.
    """
    subsets = f"{record['subsets']} subsets of {100 * record['kept']:.0f} %"
    return [
        "## Stability",
        "",
        f"Median over {len(record['captures'])} captures, each taken for one material, of how far",
        "estimates move, divided by",
        f"the standard deviation that they state: over {subsets} of the frames or of the voxels",
        "and over voxel sizes, their own standard deviation; with all colours one level brighter,",
        "a tenth of the frames left out, or poses wrong by 0.1 mm and 1e-4 rad, the distance from",
        "the unchanged estimate.",
        "",
        *table(["change", *WARD_NAMES], [[k, *of] for k, of in record["medians"].items()]),
        "",
    ]


def failures(record: Record) -> Lines:
    """Section: the scenes with the largest errors, one by one.

    Args:
        record: Result of :func:`.find_failures`, with the ``picture`` of each.
    """
    found = record["failures"]
    lines = [
        "## Largest errors",
        "",
        f"The {len(found)} of {record['scenes']} unseen scenes with the largest error of lightnet;",
        *_without(record),
        "Each row shows the view with most of the object, the observed light (dimmed where it was",
        "not observed but completed), and a sphere of the true and of the estimated material",
        "under another environment. Listed are the measures in which the scene is among the worst",
        "tenth of the split.",
        "",
    ]
    for number, failure in enumerate(found, start=1):
        lines += _failure(number, failure)
    return lines


def _without(record: Record) -> Lines:
    if record["without_them"] is None:
        return []
    return [
        f"without them the split's RMSE is {record['without_them']:.3f} instead of "
        f"{record['rmse']:.3f}."
    ]


def _failure(number: int, failure: Record) -> Lines:
    rows = [
        [name, *(float(value) for value in of)]
        for name, of in (
            ("truth", failure["truth"]),
            ("estimate", failure["estimate"]),
            ("stated deviation", failure["stddev"]),
        )
    ]
    return [
        f"### {number}. {failure['shape']} in {failure['environment']}: {failure['error']:.2f}",
        "",
        f"![Scene, light, truth and estimate]({failure['picture']})",
        "",
        f"Unseen scene {failure['index']}, {failure['view_pattern']} of views: "
        + "; ".join(failure["reasons"])
        + ".",
        "",
        *table(["", *WARD_NAMES], rows),
        "",
    ]
