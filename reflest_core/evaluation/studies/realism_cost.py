# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the faults of a real capture cost each network: one fault at a time, and all together."""

from __future__ import annotations

from typing import Any

from reflest_core.evaluation.contenders import LIGHTNET, Contender, named
from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.shown_scenes import shown
from reflest_core.evaluation.statistics.accuracy import accuracy
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.sample import Degradation

FAULTS_SEED = 1
NETWORKS = (LIGHTNET, "hemicnn-rmse1", "grouplet-rmse1")


def measure_realism(contenders: list[Contender], scenes: list[SynbrdfScene]) -> dict[str, Any]:
    """RMSE of the networks on clean ``scenes``, with each effect alone and with all of them."""
    wanted = [named(contenders, name) for name in NETWORKS]
    networks = [contender for contender in wanted if contender is not None]
    estimators = {contender.name: contender.estimator() for contender in networks}
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
    titles = {contender.name: contender.title for contender in networks}
    return {"scenes": len(scenes), "networks": titles, "rows": rows}
