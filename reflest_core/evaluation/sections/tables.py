# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sections: Tables 2 and 3, and a breakdown of the errors."""

from __future__ import annotations

from statistics import fmean

from reflest_core.evaluation.paper_figures import MATERIALS
from reflest_core.evaluation.sections.markdown import (
    Lines,
    Record,
    interval,
    percent,
    spread,
    table,
)
from reflest_core.models.card import LABCD_NAMES, WARD_NAMES


def table_2(record: Record) -> Lines:
    """Section: Table 2 in both parameterisations, split by split.

    Args:
        record: ``rows`` of :func:`.measure_table_2`.
    """
    lines = ["## Table 2: the paper's variants and lightnet", ""]
    for split in dict.fromkeys(row["split"] for row in record["rows"]):
        rows = [row for row in record["rows"] if row["split"] == split]
        counts = rows[0]["accuracy"]
        lines += [
            f"### {split.capitalize()}: {counts['scenes']} scenes under "
            f"{counts['environments']} environments",
            "",
            *_ward_table(rows, with_paper=split == "validation"),
            "",
            "The same estimates in `L, a, b, c, d`:",
            "",
            *_labcd_table(rows),
            "",
        ]
    return lines


def _ward_table(rows: list[Record], with_paper: bool) -> Lines:
    header = ["network", "RMSE", "95 %, scenes", "95 %, environments"]
    header += ["scene mean", "median", "p95", "mean of five", "95 %, environments", *WARD_NAMES]
    header += ["paper", "paper's users"] if with_paper else []
    body = []
    for row in rows:
        of = row["accuracy"]
        cells = [row["title"], of["ward"]["overall"]]
        cells += [interval(of["over_scenes"]), interval(of["over_environments"])]
        by_parameter = of["ward"]["per_parameter"]
        cells += [*spread(of["ward"]), fmean(by_parameter)]
        cells += [interval(of["mean_over_environments"]), *by_parameter]
        body.append(cells + ([row["paper_rmse"], row["paper_rank"]] if with_paper else []))
    return table(header, body)


def _labcd_table(rows: list[Record]) -> Lines:
    header = ["network", "RMSE", "scene mean", "median", "p95", *LABCD_NAMES]
    body = []
    for row in rows:
        of = row["accuracy"]["labcd"]
        body.append([row["title"], of["overall"], *spread(of), *of["per_parameter"]])
    return table(header, body)


def breakdown(record: Record) -> Lines:
    """Section: errors by parameter, gloss and environment.

    Args:
        record: ``rows`` of :func:`.measure_table_2`.
    """
    rows = [row for row in record["rows"] if row["split"] == "validation"]
    of = {row["title"]: row["breakdown"] for row in rows}
    shares = [[title, *map(percent, found["parameter_shares"])] for title, found in of.items()]
    fifths = next(iter(of.values()))["fifths"]
    spans = [f"rho_s {low:.2f} to {high:.2f}" for low, high in (f["rho_s"] for f in fifths)]
    by_gloss = [
        [title, *(f"{f['rmse']:.3f} ({f['alpha_rmse']:.3f})" for f in found["fifths"])]
        for title, found in of.items()
    ]
    lights = [
        [title, _named(found["environments"][:3]), _named(found["environments"][-3:][::-1])]
        for title, found in of.items()
    ]
    return [
        "## Breakdown of the errors",
        "",
        "Shares of the squared error on validation:",
        "",
        *table(["variant", *WARD_NAMES], shares),
        "",
        "RMSE by fifths of the true specular albedo, in brackets that of `alpha` alone:",
        "",
        *table(["variant", *spans], by_gloss),
        "",
        "The environments with the smallest and the largest errors (RMSE, scenes):",
        "",
        *table(["variant", "best", "worst"], lights),
        "",
    ]


def _named(environments: list[Record]) -> str:
    return ", ".join(f"{e['environment']} ({e['rmse']:.2f}, {e['scenes']})" for e in environments)


def table_3(record: Record) -> Lines:
    """Section: ten scenes of SynBRDF, then the paper's ten.

    Args:
        record: Result of :func:`.measure_table_3`.
    """
    header = ["variant", "all", *record["materials"]]
    measured = [[row["title"], row["average"], *row["errors"]] for row in record["rows"]]
    theirs = [
        [row["title"], row["paper"]["rmse"], *map(float, row["paper"]["materials"])]
        for row in record["rows"]
        if row["paper"] is not None
    ]
    return [
        "## Table 3: ten materials",
        "",
        "RMSE over the five parameters of ten validation scenes, drawn by a fixed seed; `all` is",
        "the mean over all validation scenes.",
        "",
        *table(header, measured),
        "",
        "The paper's ten are other scenes of another data set; its figures, for comparison of",
        "their spread:",
        "",
        *table(["variant", "all", *MATERIALS], theirs),
        "",
    ]
