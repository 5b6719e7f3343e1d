# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The page's sections, each from one record; no figure is typed."""

from __future__ import annotations

from typing import Any

from reflest_core.evaluation.markdown import table
from reflest_core.evaluation.paper_figures import MATERIALS
from reflest_core.models.normalisation import LABCD_NAMES, WARD_NAMES

Record = dict[str, Any]
Lines = list[str]


def table_2(record: Record) -> Lines:
    """Both splits, both parameterisations."""
    lines = ["## Table 2: the seven variants", ""]
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
    header = ["variant", "RMSE", "95 %, scenes", "95 %, environments"]
    header += ["scene mean", "median", "p95", *WARD_NAMES]
    header += ["paper", "paper's users"] if with_paper else []
    body = []
    for row in rows:
        of = row["accuracy"]
        cells = [row["title"], of["ward"]["overall"]]
        cells += [_interval(of["over_scenes"]), _interval(of["over_environments"])]
        cells += [*_spread(of["ward"]), *of["ward"]["per_parameter"]]
        body.append(cells + ([row["paper_rmse"], row["paper_rank"]] if with_paper else []))
    return table(header, body)


def _labcd_table(rows: list[Record]) -> Lines:
    header = ["variant", "RMSE", "scene mean", "median", "p95", *LABCD_NAMES]
    body = []
    for row in rows:
        of = row["accuracy"]["labcd"]
        body.append([row["title"], of["overall"], *_spread(of), *of["per_parameter"]])
    return table(header, body)


def _spread(rmse: Record) -> list[float]:
    return [rmse["scene_mean"], rmse["scene_median"], rmse["scene_p95"]]


def _interval(interval: Record) -> str:
    return f"{interval['low']:.3f} to {interval['high']:.3f}"


def breakdown(record: Record) -> Lines:
    """What holds the variants back, from Table 2's record."""
    rows = [row for row in record["rows"] if row["split"] == "validation"]
    of = {row["title"]: row["breakdown"] for row in rows}
    shares = [
        [title, *(f"{100 * share:.0f} %" for share in found["parameter_shares"])]
        for title, found in of.items()
    ]
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
        "## What holds them back",
        "",
        "Shares of the squared error on validation:",
        "",
        *table(["variant", *WARD_NAMES], shares),
        "",
        "RMSE by fifths of the true specular strength, in brackets that of `alpha` alone:",
        "",
        *table(["variant", *spans], by_gloss),
        "",
        "The lights under which the estimates are best and worst (RMSE, scenes):",
        "",
        *table(["variant", "best", "worst"], lights),
        "",
    ]


def _named(environments: list[Record]) -> str:
    return ", ".join(f"{e['environment']} ({e['rmse']:.2f}, {e['scenes']})" for e in environments)


def table_3(record: Record) -> Lines:
    """Ten of our scenes, then the paper's ten."""
    header = ["variant", "all", *record["materials"]]
    ours = [[row["title"], row["average"], *row["errors"]] for row in record["rows"]]
    theirs = [
        [row["title"], row["paper"]["rmse"], *map(float, row["paper"]["materials"])]
        for row in record["rows"]
    ]
    return [
        "## Table 3: ten materials",
        "",
        "RMSE over the five parameters of ten validation scenes, drawn by a fixed seed; `all` is",
        "the mean over all validation scenes.",
        "",
        *table(header, ours),
        "",
        "The paper's ten are other scenes of another data set; its figures, for comparison of",
        "their spread:",
        "",
        *table(["variant", "all", *MATERIALS], theirs),
        "",
    ]


def views(record: Record) -> Lines:
    """Figure 6."""
    header = ["network", *(f"{count} views" for count in record["views"])]
    body = [[curve["network"], *curve["rmse"]] for curve in record["curves"]]
    return [
        "## Figure 6: error against the number of views",
        "",
        "![Error against views](views.png)",
        "",
        f"RMSE on {record['scenes']} validation scenes of which only so many random views are",
        "kept. The paper's figure has no numbers; it puts the effective amount around 30 views.",
        "",
        *table(header, body),
        "",
    ]


def latency(record: Record) -> Lines:
    """Size and time."""
    header = ["model", "bytes", "paper", "median ms", "p95 ms", "paper"]
    body = [
        [
            row["model"], row["bytes"], row["paper_bytes"], f"{row['median_ms']:.1f}",
            f"{row['p95_ms']:.1f}", f"{row['paper_ms']:.0f}",
        ]
        for row in record["rows"]
    ]  # fmt: skip
    return [
        "## Size and latency",
        "",
        "Voxel choice, features and network for a SynBRDF scene with all its views, on",
        f"{record['machine']}; the paper does not name its machine.",
        "",
        *table(header, body),
        "",
    ]


def eight_bit(record: Record) -> Lines:
    """What quantisation costs."""
    header = ["variant", "float32", "8-bit", "difference", "float32 bytes", "8-bit bytes"]
    body = [
        [
            row["title"], f"{row['float32']:.4f}", f"{row['eight_bit']:.4f}",
            f"{row['eight_bit'] - row['float32']:+.4f}", row["float32_bytes"],
            row["eight_bit_bytes"],
        ]
        for row in record["rows"]
    ]  # fmt: skip
    return [
        "## What 8-bit weights cost",
        "",
        f"RMSE on {record['scenes']} validation scenes. Grouplet is shipped in 8 bits (in float32",
        "it misses the paper's 340 KB), HemiCNN in float32. A variant is left out where its",
        "float32 weights were not kept.",
        "",
        *table(header, body),
        "",
    ]


def baselines(record: Record) -> Lines:
    """Rivals on the same scenes."""
    header = ["method", "split", "scenes", "RMSE", "95 %, scenes", *WARD_NAMES]
    header += ["seconds a scene", "paper's seconds"]
    body = []
    for row in sorted(record["rows"], key=lambda r: (r["split"], r["accuracy"]["scenes"])):
        of = row["accuracy"]
        cells = [row["name"], row["split"], of["scenes"], of["ward"]["overall"]]
        cells += [_interval(of["over_scenes"]), *of["ward"]["per_parameter"]]
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
    """The ranking by looks."""
    lights = list(next(iter(record["flip_by_light"].values())))
    header = ["rank", "variant", "mean rank", "first of", "FLIP", "PSNR dB", "SSIM"]
    header += [f"FLIP, {light}" for light in lights] + ["paper's users"]
    body = []
    for rank, row in enumerate(record["rows"], start=1):
        by_light = record["flip_by_light"][row["variant"]]
        cells = [rank, row["variant"], f"{row['mean_rank']:.2f}", f"{100 * row['first']:.0f} %"]
        cells += [row["flip"], f"{row['psnr']:.1f}", row["ssim"]]
        body.append([*cells, *(by_light[light] for light in lights), row["paper_rank"]])
    agreement = record["rank_correlation"]
    remark = [] if agreement is None else [
        f"Spearman's correlation of this order with that of the paper's users: {agreement:.2f}.", ""
    ]  # fmt: skip
    return [
        "## How they look",
        "",
        "![Truth and estimates](contact-sheet.png)",
        "",
        f"In place of ten users: the truth and every estimate of {record['materials']} materials",
        f"rendered on a sphere and a bumpy object under {', '.join(record['lights'])} (none of",
        "which training scenes stood in) and a point light in four places. Variants are ordered",
        "by their mean rank in FLIP, material by material.",
        "",
        *table(header, body),
        "",
        *remark,
    ]


def quick(record: Record) -> Lines:
    """The row that anyone can repeat."""
    return [
        "## One row, reproduced anywhere",
        "",
        "`reflest evaluate --quick` estimates all validation scenes again from a shipped file of",
        f"{record['bytes'] / 1e6:.1f} MB that holds the voxels HemiCNN looks at, and fails unless",
        f"{record['variant']} reaches {record['rmse']:.4f} again on {record['scenes']} scenes.",
        "",
    ]
