"""Evaluations as files: JSON for programs, a Markdown page for people."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.models.normalisation import LABCD_NAMES, WARD_NAMES
from reflest_core.training.evaluation import Evaluation
from reflest_core.training.metrics import NormalisedRmse

PAPER_RMSE = {"hemicnn": 0.419, "grouplet-fast": None, "grouplet-slow": 0.432}
"""Kim et al. 2017, Table 2, RMSE_1 on their validation set; Grouplet there is Grouplet-slow."""


def write_report(folder: Path, evaluations: list[Evaluation], provenance: dict[str, Any]) -> None:
    """Write ``accuracy.json`` and ``accuracy.md``; ``provenance``: command, data, commit."""
    folder.mkdir(parents=True, exist_ok=True)
    record = {"provenance": provenance, "evaluations": [_record(row) for row in evaluations]}
    (folder / "accuracy.json").write_text(json.dumps(record, indent=1, default=_plain) + "\n")
    (folder / "accuracy.md").write_text(_page(evaluations, provenance))


def _record(evaluation: Evaluation) -> dict[str, Any]:
    return {
        "model": evaluation.model,
        "split": evaluation.split,
        "scenes": len(evaluation.truths),
        "ward": dataclasses.asdict(evaluation.ward),
        "labcd": dataclasses.asdict(evaluation.labcd),
    }


def _page(evaluations: list[Evaluation], provenance: dict[str, Any]) -> str:
    lines = [
        "# Accuracy",
        "",
        "Normalised RMSE: every parameter z-scored with the training set's mean and standard",
        "deviation; 1.0 is about what guessing the mean costs. Written by",
        f"`{provenance['command']}` at commit `{provenance['commit']}`;",
        f"data: {provenance['data']}.",
    ]
    for split in dict.fromkeys(evaluation.split for evaluation in evaluations):
        rows = [evaluation for evaluation in evaluations if evaluation.split == split]
        lines += ["", f"## Split: {split} ({len(rows[0].truths)} scenes)", ""]
        lines += _table(rows, "ward", WARD_NAMES, with_paper=split == "validation")
        lines += [""]
        lines += _table(rows, "labcd", LABCD_NAMES, with_paper=False)
    return "\n".join(lines) + "\n"


def _table(
    rows: list[Evaluation], parameters: str, names: tuple[str, ...], with_paper: bool
) -> list[str]:
    """A Markdown table: RMSE over all, per parameter, and over scenes."""
    header = ["model", "all", *names, "scene mean", "median", "p95"]
    header += ["paper"] if with_paper else []
    lines = ["| " + " | ".join(header) + " |", "|---" * len(header) + "|"]
    for row in rows:
        measured: NormalisedRmse = getattr(row, parameters)
        figures = [measured.overall, *measured.per_parameter]
        figures += [measured.scene_mean, measured.scene_median, measured.scene_p95]
        cells = [row.model, *(f"{figure:.3f}" for figure in figures)]
        if with_paper:
            paper = PAPER_RMSE.get(row.model.split("/")[0])
            cells.append("" if paper is None else f"{paper:.3f}")
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no JSON form")
