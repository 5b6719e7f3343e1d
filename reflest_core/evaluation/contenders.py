# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The trained networks that are measured: the paper's variants that have weights, and ours."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from reflest_core.errors import ReflestError
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.models.model_choice import MODELS
from reflest_core.models.predictor import Predictor
from reflest_core.models.weights import SHIPPED
from reflest_core.training.variants import VARIANTS

LIGHTNET = "lightnet"


class EvaluationError(ReflestError):
    """There is nothing to evaluate, or what an evaluation needs is missing."""


@dataclass(frozen=True)
class Contender:
    """A network that estimates as ``model``, a key of :data:`MODELS`, with weights at ``weights``.

    ``name``: of the variant of Table 2, or ``lightnet``. ``exact``: the same weights unquantised,
    if kept.
    """

    name: str
    title: str
    model: str
    weights: Path
    exact: Path | None = None

    @property
    def network(self) -> str:
        """Its architecture."""
        return MODELS[self.model].network

    def predictor(self) -> Predictor:
        """Ready to look at surfaces, on one thread."""
        return Predictor(self.model, self.weights)

    def estimator(self) -> Estimator:
        """The whole live path behind a store, on one thread; it estimates from a single voxel."""
        return Estimator(
            EstimationSettings(model=self.model, weights=str(self.weights), min_voxels=1)
        )

    def as_fast(self) -> Contender:
        """The same weights at Grouplet-fast's 20 voxels."""
        return dataclasses.replace(self, model="grouplet-fast")


def find_contenders(runs: Path | None) -> list[Contender]:
    """Networks trained into ``runs`` (``runs/<variant>/``), or without it the shipped ones.

    ``lightnet`` stands beside them in any case: from ``runs`` if it is there, else as shipped.
    """
    found = []
    for variant in VARIANTS:
        weights = variant.shipped if runs is None else runs / variant.name / variant.file_name
        if weights.is_file():
            exact = weights.with_name(f"{variant.name}-float32.safetensors")
            kept = exact if exact.is_file() else None
            found.append(Contender(variant.name, variant.title, variant.model, weights, kept))
    ours = [] if runs is None else [runs / LIGHTNET / MODELS[LIGHTNET].file]
    trained = next((path for path in ours if path.is_file()), None)
    if not found and trained is None:
        place = "this installation" if runs is None else runs
        raise EvaluationError(
            f"{place} holds no weights of a variant of Table 2; train one with 'reflest train DATA "
            "--variant NAME --out RUNS/NAME' and give --runs RUNS"
        )
    weights = trained or SHIPPED / MODELS[LIGHTNET].file
    if weights.is_file():
        found.append(Contender(LIGHTNET, "lightnet (ours)", LIGHTNET, weights))
    return found


def named(contenders: list[Contender], name: str) -> Contender | None:
    """The contender of that name, if it has weights."""
    return next((contender for contender in contenders if contender.name == name), None)


def known_light(contenders: list[Contender]) -> Contender:
    """lightnet; :class:`EvaluationError` where it has no weights."""
    contender = named(contenders, LIGHTNET)
    if contender is None:
        raise EvaluationError(
            "there are no weights of lightnet; train them with 'reflest train DATA --model "
            "lightnet --out RUNS/lightnet' and give --runs RUNS"
        )
    return contender
