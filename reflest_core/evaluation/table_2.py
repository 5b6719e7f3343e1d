# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Table 2 and Table 3: the networks on validation and on unseen scenes, and on ten materials."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from reflest_core.evaluation.contenders import Contender
from reflest_core.evaluation.estimates import SceneEstimates, estimate_all
from reflest_core.evaluation.paper_figures import MATERIALS, TABLES_2_AND_3
from reflest_core.evaluation.statistics.accuracy import Accuracy, accuracy, scene_errors
from reflest_core.evaluation.statistics.breakdown import break_down
from reflest_core.training.data.sample import Sample

MATERIAL_SEED = 3
"""Draws Table 3's ten scenes from the validation split."""

Estimates = dict[str, dict[str, SceneEstimates]]
"""By split and variant."""


@dataclass(frozen=True)
class Row:
    """One network on one split, beside the paper's figures for it, where it is the paper's.

    ``breakdown``: of :func:`~.breakdown.break_down`.
    """

    variant: str
    title: str
    model_id: str
    split: str
    accuracy: Accuracy
    breakdown: dict[str, Any]
    paper_rmse: float | None
    paper_rank: int | None


def measure_table_2(
    contenders: list[Contender], splits: dict[str, list[Sample]]
) -> tuple[list[Row], Estimates]:
    """Every contender on every split."""
    rows: list[Row] = []
    estimates: Estimates = {split: {} for split in splits}
    for contender in contenders:
        estimator = contender.estimator()
        statistics = estimator.predictor.card.statistics
        paper = TABLES_2_AND_3.get(contender.name)
        for split, samples in splits.items():
            made = estimate_all(estimator, samples, f"{contender.name} on {split}")
            estimates[split][contender.name] = made
            theirs = paper if split == "validation" else None
            rows.append(
                Row(
                    contender.name,
                    contender.title,
                    estimator.predictor.model_id,
                    split,
                    accuracy(made.ward, samples, statistics),
                    break_down(made.ward, samples, statistics),
                    None if theirs is None else theirs.rmse,
                    None if theirs is None else theirs.rank,
                )
            )
    return rows, estimates


def measure_table_3(
    contenders: list[Contender], samples: list[Sample], estimates: dict[str, SceneEstimates]
) -> dict[str, Any]:
    """RMSE of ten validation scenes, drawn by seed, beside the paper's ten (other scenes)."""
    count = min(len(MATERIALS), len(samples))
    drawn = np.random.default_rng(MATERIAL_SEED).permutation(len(samples))[:count]
    rows = []
    for contender in contenders:
        errors = scene_errors(
            estimates[contender.name].ward, samples, contender.predictor().card.statistics
        )
        rows.append(
            {
                "variant": contender.name,
                "title": contender.title,
                "errors": errors[drawn].tolist(),
                "average": float(errors.mean()),
                "paper": _theirs(contender.name),
            }
        )
    return {
        "materials": [f"v{samples[index].index}" for index in drawn],
        "wards": [samples[index].ward.tolist() for index in drawn],
        "rows": rows,
    }


def _theirs(name: str) -> dict[str, Any] | None:
    paper = TABLES_2_AND_3.get(name)
    return None if paper is None else dataclasses.asdict(paper)
