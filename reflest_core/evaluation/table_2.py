# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Tables 2 and 3: the networks on validation and on unseen scenes, and on ten materials."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from reflest_core.evaluation.estimates import Estimates, SceneEstimates, estimate_all
from reflest_core.evaluation.networks import EvaluatedNetwork
from reflest_core.evaluation.paper_figures import MATERIALS, TABLES_2_AND_3
from reflest_core.evaluation.statistics.accuracy import Accuracy, accuracy, scene_errors
from reflest_core.evaluation.statistics.breakdown import break_down
from reflest_core.training.data.sample import Sample

MATERIAL_SEED = 3
"""Draws Table 3's ten scenes from the validation split."""


@dataclass(frozen=True)
class Row:
    """One network on one split, with the paper's figures where it has them.

    Attributes:
        variant: The network's name.
        title: Its name in tables.
        model_id: Its weights.
        split: ``validation`` or ``unseen``.
        accuracy: Errors and their intervals.
        breakdown: Result of :func:`.break_down`.
        paper_rmse: The paper's RMSE, or None.
        paper_rank: The rank by the paper's users, or None.
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
    networks: list[EvaluatedNetwork], splits: dict[str, list[Sample]]
) -> tuple[list[Row], Estimates]:
    """Measure every network on every split.

    Args:
        networks: The networks to compare.
        splits: The scenes of each split.

    Returns:
        The table's rows, and the estimates that they were computed from.
    """
    rows: list[Row] = []
    estimates: Estimates = {split: {} for split in splits}
    for network in networks:
        estimator = network.estimator()
        statistics = estimator.predictor.card.statistics
        paper = TABLES_2_AND_3.get(network.name)
        for split, samples in splits.items():
            made = estimate_all(estimator, samples, f"{network.name} on {split}")
            estimates[split][network.name] = made
            theirs = paper if split == "validation" else None
            rows.append(
                Row(
                    network.name,
                    network.title,
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
    networks: list[EvaluatedNetwork], samples: list[Sample], estimates: dict[str, SceneEstimates]
) -> dict[str, Any]:
    """RMSE of ten validation scenes, drawn at random by a fixed seed.

    Args:
        networks: The networks to compare.
        samples: The validation scenes.
        estimates: Their estimates, by network.

    Returns:
        The record of Table 3, with the paper's ten materials beside it.
    """
    count = min(len(MATERIALS), len(samples))
    drawn = np.random.default_rng(MATERIAL_SEED).permutation(len(samples))[:count]
    rows = []
    for network in networks:
        errors = scene_errors(
            estimates[network.name].ward, samples, network.predictor().card.statistics
        )
        rows.append(
            {
                "variant": network.name,
                "title": network.title,
                "errors": errors[drawn].tolist(),
                "average": float(errors.mean()),
                "paper": _theirs(network.name),
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
