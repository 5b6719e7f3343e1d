# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The seven variants of the paper's Table 2: network, loss and lambda of each."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from reflest_core.models.definition import SHIPPED
from reflest_core.models.recipe import Recipe
from reflest_core.models.registry import network_named
from reflest_core.training.data.sample import TrainingError


@dataclass(frozen=True)
class Variant:
    """One row of Table 2.

    Attributes:
        name: On the command line and of its files.
        title: In tables.
        network: Name of its network.
        model: Name of the model that estimates with it.
        loss: ``rmse1``, ``rmse2`` or ``cuberoot``.
        colour_constancy: lambda of E_c, 0.01 where the paper writes ``+ E_c`` (section 3.2).
    """

    name: str
    title: str
    network: str
    model: str
    loss: str
    colour_constancy: float

    @property
    def file_name(self) -> str:
        """Name of its weight file, in a training's folder and among the shipped ones."""
        return f"{self.name}.safetensors"

    @property
    def shipped(self) -> Path:
        """Path of its shipped weights; not every variant is shipped."""
        return SHIPPED / self.file_name

    def recipe(self, origin: str = "ours") -> Recipe:
        """Return its recipe, of origin ``paper`` or ``ours``.

        Args:
            origin: ``ours`` or ``paper``.

        Raises:
            ParameterError: There is no recipe of that origin.
        """
        base = network_named(self.network).recipe(origin)
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
    """Return the variant of that name.

    Args:
        name: Of a variant.

    Raises:
        TrainingError: There is none; the sentence lists those that there are.
    """
    for variant in VARIANTS:
        if variant.name == name:
            return variant
    known = ", ".join(variant.name for variant in VARIANTS)
    raise TrainingError(f"there is no variant {name!r}; choose one of {known}")
