# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The faults of a real capture: the error that they add, and what training with them changes."""

from __future__ import annotations

from typing import Any

from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.networks import (
    LIGHTNET,
    EvaluatedNetwork,
    EvaluationError,
    network_named,
)
from reflest_core.evaluation.shown_scenes import shown
from reflest_core.evaluation.statistics.accuracy import accuracy
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.sample import Degradation, Sample

FAULTS_SEED = 1
NETWORKS = (LIGHTNET, "hemicnn-rmse1", "grouplet-rmse1")


def measure_realism(networks: list[EvaluatedNetwork], scenes: list[SynbrdfScene]) -> dict[str, Any]:
    """RMSE of the networks on clean scenes, with each fault alone, and with all of them.

    Args:
        networks: The networks to compare.
        scenes: Clean scenes.

    Returns:
        The record of the part ``realism``.
    """
    wanted = [network_named(networks, name) for name in NETWORKS]
    networks = [network for network in wanted if network is not None]
    estimators = {network.name: network.estimator() for network in networks}
    cases = {"none": [], **{effect.value: [effect] for effect in Effect}, "all": list(Effect)}
    rows = []
    for name, effects in cases.items():
        degradation = Degradation(Realism.only(effects), FAULTS_SEED)
        samples = [shown(degradation.applied(scene)) for scene in scenes]
        errors = {}
        for network, estimator in estimators.items():
            made = estimate_all(estimator, samples, f"{network}, {name}")
            statistics = estimator.predictor.card.statistics
            errors[network] = accuracy(made.ward, samples, statistics).ward.overall
        rows.append({"effect": name, "rmse": errors})
    titles = {network.name: network.title for network in networks}
    return {"scenes": len(scenes), "networks": titles, "rows": rows}


def measure_realism_training(
    networks: list[EvaluatedNetwork], unhardened: list[EvaluatedNetwork], scenes: list[SynbrdfScene]
) -> dict[str, Any]:
    """RMSE of networks trained without and with faults, on clean scenes and with all faults.

    Args:
        networks: The networks to compare, trained with faults.
        unhardened: The same variants trained without.
        scenes: Clean scenes.

    Raises:
        EvaluationError: no variant has been trained in both ways.
    """
    degradation = Degradation(Realism.only(list(Effect)), FAULTS_SEED)
    samples = {
        "clean": [shown(scene) for scene in scenes],
        "faults": [shown(degradation.applied(scene)) for scene in scenes],
    }
    rows = []
    for one in unhardened:
        other = network_named(networks, one.name)
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


def _errors(network: EvaluatedNetwork, samples: dict[str, list[Sample]]) -> dict[str, float]:
    """RMSE by what the scenes suffer."""
    estimator = network.estimator()
    statistics = estimator.predictor.card.statistics
    errors = {}
    for name, some in samples.items():
        made = estimate_all(estimator, some, f"{network.name}, {name}")
        errors[name] = accuracy(made.ward, some, statistics).ward.overall
    return errors
