# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What it buys to train with the faults of a real capture, and what it costs on clean scenes."""

from __future__ import annotations

from typing import Any

from reflest_core.evaluation.contenders import Contender, EvaluationError, named
from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.shown_scenes import shown
from reflest_core.evaluation.statistics.accuracy import accuracy
from reflest_core.evaluation.studies.realism_cost import FAULTS_SEED
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.sample import Degradation, Sample


def measure_realism_training(
    contenders: list[Contender], unhardened: list[Contender], scenes: list[SynbrdfScene]
) -> dict[str, Any]:
    """RMSE on clean ``scenes`` and with all faults: of networks trained without and with them.

    ``unhardened``: trained without faults; each is compared with the contender of its name.
    """
    degradation = Degradation(Realism.only(list(Effect)), FAULTS_SEED)
    samples = {
        "clean": [shown(scene) for scene in scenes],
        "faults": [shown(degradation.applied(scene)) for scene in scenes],
    }
    rows = []
    for one in unhardened:
        other = named(contenders, one.name)
        if other is not None and other.weights != one.weights:
            rows.append(
                {
                    "network": one.title,
                    "recipe": other.predictor().card.recipe,
                    "without": _errors(one, samples),
                    "with": _errors(other, samples),
                }
            )
    if not rows:
        raise EvaluationError("--unhardened holds no network that --runs has trained otherwise")
    return {"scenes": len(scenes), "rows": rows}


def _errors(contender: Contender, samples: dict[str, list[Sample]]) -> dict[str, float]:
    """RMSE by what the scenes suffer."""
    estimator = contender.estimator()
    statistics = estimator.predictor.card.statistics
    errors = {}
    for name, some in samples.items():
        made = estimate_all(estimator, some, f"{contender.name}, {name}")
        errors[name] = accuracy(made.ward, some, statistics).ward.overall
    return errors
