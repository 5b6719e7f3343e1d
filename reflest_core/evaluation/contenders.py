# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The trained networks that are measured: whichever variants of Table 2 have weights."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from reflest_core.errors import ReflestError
from reflest_core.models.predictor import Predictor
from reflest_core.training.variants import VARIANTS, Variant


class EvaluationError(ReflestError):
    """There is nothing to evaluate, or what an evaluation needs is missing."""


@dataclass(frozen=True)
class Contender:
    """A variant with weights at ``weights``; ``exact``: the same weights unquantised, if kept."""

    variant: Variant
    weights: Path
    exact: Path | None

    @property
    def name(self) -> str:
        """The variant's name."""
        return self.variant.name

    def predictor(self) -> Predictor:
        """Ready to estimate."""
        return Predictor(self.variant.model, self.weights)

    def as_fast(self) -> Contender:
        """The same weights at Grouplet-fast's 20 voxels."""
        variant = dataclasses.replace(self.variant, model="grouplet-fast")
        return dataclasses.replace(self, variant=variant)


def find_contenders(runs: Path | None) -> list[Contender]:
    """Variants trained into ``runs`` (``runs/<variant>/``), or without it the shipped ones."""
    found = []
    for variant in VARIANTS:
        weights = variant.shipped if runs is None else runs / variant.name / variant.file_name
        if weights.is_file():
            exact = weights.with_name(f"{variant.name}-float32.safetensors")
            found.append(Contender(variant, weights, exact if exact.is_file() else None))
    if not found:
        place = "this installation" if runs is None else runs
        raise EvaluationError(
            f"{place} holds no weights of a variant of Table 2; train one with 'reflest train DATA "
            "--variant NAME --out RUNS/NAME' and give --runs RUNS"
        )
    return found


def named(contenders: list[Contender], name: str) -> Contender | None:
    """The contender of that variant, if it has weights."""
    return next((contender for contender in contenders if contender.name == name), None)
