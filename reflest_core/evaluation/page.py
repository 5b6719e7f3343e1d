# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``index.md``: all records as one page with plots; parts that were not measured are left out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.pictures.plots import (
    draw_accuracy,
    draw_reliability,
    draw_scatter,
    draw_views,
)
from reflest_core.evaluation.record_file import read_record
from reflest_core.evaluation.sections import (
    ablations,
    comparisons,
    cost,
    held_out,
    materials,
    tables,
    uncertainty,
    views,
)
from reflest_core.evaluation.sections.markdown import Lines, Record
from reflest_core.whole_file import write_whole

SECTIONS: dict[str, Callable[[Record], Lines]] = {
    "table-2": tables.table_2,
    "table-3": tables.table_3,
    "views": views.views,
    "look-around": views.look_around,
    "calibration": uncertainty.calibration,
    "held-out-lights": held_out.held_out_lights,
    "failures": uncertainty.failures,
    "ablation": ablations.ablation,
    "stability": uncertainty.stability,
    "realism": ablations.realism,
    "realism-training": ablations.realism_training,
    "latency": cost.latency,
    "eight-bit": cost.eight_bit,
    "baselines": comparisons.baselines,
    "perception": comparisons.perception,
    "materials": materials.materials,
    "quick": cost.quick,
}
PLOTS = {
    "views": draw_views,
    "calibration": draw_reliability,
}
"""Each into a file of its section's name."""

INTRODUCTION = [
    "# Results on SynBRDF",
    "",
    "Errors are normalised RMSE: every parameter z-scored with the training set's mean and",
    "standard deviation; guessing the mean gives about 1.0. `RMSE` is the root mean square",
    "over scenes and parameters; `scene mean`, `median` and `p95` are of each scene's own RMSE;",
    "`mean of five` is the mean of the parameters' RMSEs.",
    "The *unseen* split's environments and shapes appear in no scene that a network was trained",
    "or selected on. 95 % intervals are bootstrapped over scenes, or over environments, for errors",
    "under one environment are correlated. The paper's figures (Kim et al. 2017, Tables 2 and 3,",
    "section 3.3) are of its own data set. `reflest evaluate` writes this page from the JSON files",
    "beside it.",
    "",
]


def write_page(folder: Path) -> Path:
    """Write ``index.md`` and its plots from the records in a folder.

    Args:
        folder: Where the records are and the page goes.

    Returns:
        The path of the page.

    Raises:
        EvaluationError: there are no records, or one was written by another version.
    """
    records = {name: read_record(folder / f"{name}.json") for name in SECTIONS}
    measured = {name: record for name, record in records.items() if record is not None}
    if not measured:
        raise EvaluationError(f"{folder} holds no records; run 'reflest evaluate DATA' first")
    lines = list(INTRODUCTION)
    for name, record in measured.items():
        try:
            lines += _section(folder, name, record)
        except (KeyError, TypeError) as error:
            raise EvaluationError(
                f"{folder / name}.json lacks a field that the page shows ({error}): another "
                f"version of reflest wrote it; measure it again with --parts {_part(name)}"
            ) from error
    path = folder / "index.md"
    write_whole(path, ("\n".join(lines + _commands(measured)) + "\n").encode())
    return path


def _section(folder: Path, name: str, record: Record) -> Lines:
    section: Lines = SECTIONS[name](record)
    if name == "table-2":
        section += _draw_table_2(folder, record) + tables.breakdown(record)
    if name in PLOTS:
        PLOTS[name](folder / f"{name}.png", record)
    return section


def _draw_table_2(folder: Path, record: Record) -> Lines:
    draw_accuracy(folder / "variants.png", record)
    lines = ["![RMSE of the networks](variants.png)", ""]
    estimates = read_record(folder / "estimates.json")
    if estimates is not None:
        rows = [row for row in record["rows"] if row["split"] == "validation"]
        best = min(rows, key=lambda row: row["accuracy"]["ward"]["overall"])["variant"]
        draw_scatter(folder / "scatter.png", estimates, best)
        lines += [
            "Estimates against truths of the network that is best on validation:",
            "",
            "![Estimates against truths](scatter.png)",
            "",
        ]
    return lines


def _commands(measured: dict[str, Record]) -> Lines:
    lines = ["## How these figures were made", ""]
    for name, record in measured.items():
        made = record["provenance"]
        lines.append(
            f"- {name}: `{made['command']} --parts {_part(name)}` at commit `{made['commit']}`; "
            f"{made['data']}"
        )
    return lines


def _part(name: str) -> str:
    return "table-2" if name == "table-3" else name
