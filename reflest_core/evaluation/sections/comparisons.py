# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sections: baselines, and rendered estimates compared."""

from __future__ import annotations

from reflest_core.evaluation.sections.markdown import Lines, Record, interval, percent, table
from reflest_core.models.card import WARD_NAMES


def baselines(record: Record) -> Lines:
    """Section: baselines on the same scenes.

    Args:
        record: Result of :func:`.measure_baselines`.
    """
    header = ["method", "split", "scenes", "RMSE", "95 %, scenes", *WARD_NAMES]
    header += ["seconds a scene", "paper's seconds"]
    body = []
    for row in sorted(record["rows"], key=lambda r: (r["split"], r["accuracy"]["scenes"])):
        of = row["accuracy"]
        cells = [row["name"], row["split"], of["scenes"], of["ward"]["overall"]]
        cells += [interval(of["over_scenes"]), *of["ward"]["per_parameter"]]
        seconds = row["paper_seconds"]
        paper = None if seconds is None else f"{seconds:.0f}"
        body.append([*cells, f"{row['median_seconds']:.2g}", paper])
    return [
        "## Baselines",
        "",
        "On the same scenes: guessing the training mean; a Lambertian surface from F and B (Eq. 7",
        "with `rho_s` = 0); and an optimiser in the spirit of Lombardi and Nishino that fits a",
        "Ward BRDF and a 16 x 32 light map to one image and its normals, with a prior on natural",
        f"light. The optimiser runs on {record['subset']} scenes of each split, drawn by seed; all",
        "methods are measured on these too.",
        "",
        *table(header, body),
        "",
    ]


def perception(record: Record) -> Lines:
    """Section: networks ranked by the appearance of their estimates.

    Args:
        record: Result of :func:`.measure_perception`.
    """
    lights = list(next(iter(record["flip_by_light"].values())))
    header = ["rank", "variant", "mean rank", "first of", "FLIP", "PSNR dB", "SSIM"]
    header += [f"FLIP, {light}" for light in lights] + ["paper's users"]
    body = []
    for rank, row in enumerate(record["rows"], start=1):
        by_light = record["flip_by_light"][row["variant"]]
        cells = [rank, row["variant"], f"{row['mean_rank']:.2f}", percent(row["first"])]
        cells += [row["flip"], f"{row['psnr']:.1f}", row["ssim"]]
        body.append([*cells, *(by_light[light] for light in lights), row["paper_rank"]])
    agreement = record["rank_correlation"]
    remark = (
        []
        if agreement is None
        else [
            "Spearman's correlation of the paper's variants' order with that of its users: "
            f"{agreement:.2f}.",
            "",
        ]
    )
    return [
        "## Appearance",
        "",
        "![Truth and estimates](contact-sheet.png)",
        "",
        f"In place of ten users: the truth and every estimate of {record['materials']} validation",
        "materials, drawn by seed, rendered on a sphere and a bumpy object under",
        f"{', '.join(record['lights'])} (environments of no training scene) and a point light",
        "in four places. Networks are ordered by their mean rank in FLIP, material by material.",
        "",
        *table(header, body),
        "",
        *remark,
    ]
