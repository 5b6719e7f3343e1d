# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The seven variants of Table 2: which network, loss and lambda each is, and how it is trained."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from reflest_core.models.weights import SHIPPED
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.recipe import PAPER_RECIPES, RECIPES, Recipe


@dataclass(frozen=True)
class Variant:
    """One row of Table 2, named ``name``.

    ``model``: the key of :data:`~reflest_core.models.predictor.MODELS` by which it estimates.
    ``colour_constancy``: lambda of E_c, 0.01 wherever the paper writes ``+ E_c`` (section 3.2).
    """

    name: str
    title: str
    network: str
    model: str
    loss: str
    colour_constancy: float

    @property
    def file_name(self) -> str:
        """Of its weights, in a training's folder and among the shipped ones."""
        return f"{self.name}.safetensors"

    @property
    def shipped(self) -> Path:
        """Where its shipped weights are, if they are."""
        return SHIPPED / self.file_name

    def recipe(self, origin: str = "ours") -> Recipe:
        """Its recipe after the ``paper``'s optimisers, or ``ours``."""
        base = {"paper": PAPER_RECIPES, "ours": RECIPES}[origin][self.network]
        return dataclasses.replace(base, loss=self.loss, colour_constancy=self.colour_constancy)


def _grouplet(name: str, title: str, loss: str, colour_constancy: float = 0.0) -> Variant:
    return Variant(
        f"grouplet-{name}",
        f"Grouplet, {title}",
        "grouplet",
        "grouplet-slow",
        loss,
        colour_constancy,
    )


def _hemicnn(name: str, title: str, loss: str, colour_constancy: float = 0.0) -> Variant:
    return Variant(
        f"hemicnn-{name}", f"HemiCNN, {title}", "hemicnn", "hemicnn", loss, colour_constancy
    )


VARIANTS = (
    _grouplet("rmse1-ec", "RMSE_1 + E_c", "rmse1", 0.01),
    _grouplet("rmse1", "RMSE_1", "rmse1"),
    _hemicnn("rmse2", "RMSE_2", "rmse2"),
    _hemicnn("cuberoot", "CubeRoot", "cuberoot"),
    _hemicnn("rmse1", "RMSE_1", "rmse1"),
    _hemicnn("cuberoot-ec", "CubeRoot + E_c", "cuberoot", 0.01),
    _grouplet("rmse2", "RMSE_2", "rmse2"),
)
"""In the order of Table 2, which is that of its users' ranking."""


def variant_named(name: str) -> Variant:
    """The variant; :class:`TrainingError` names those that there are."""
    for variant in VARIANTS:
        if variant.name == name:
            return variant
    known = ", ".join(variant.name for variant in VARIANTS)
    raise TrainingError(f"there is no variant {name!r}; choose one of {known}")
