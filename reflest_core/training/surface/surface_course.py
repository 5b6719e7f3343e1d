# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Teaching the paper's two networks, which see the surface and F and B alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np
import torch

from reflest_core.brdf.parameters import WardVariant
from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.models.registry import NETWORKS
from reflest_core.models.weights import WeightsCard, save_weights
from reflest_core.training.data.sample_sets import TrainingData
from reflest_core.training.recipe import Recipe
from reflest_core.training.run_folder import RunFolder
from reflest_core.training.surface.batches import Batch, batches
from reflest_core.training.surface.drawn_scenes import SceneDrawer
from reflest_core.training.surface.objective import Objective
from reflest_core.training.surface.packed_scenes import PackedScenes
from reflest_core.training.surface.validation import Validation
from reflest_core.training.weight_average import Weights

EIGHT_BIT = {"hemicnn": False, "grouplet": True}
"""Grouplet meets the paper's size only in 8 bits (SPEC, Grouplet)."""


class SurfaceCourse:
    """A :class:`~reflest_core.training.course.Course` for HemiCNN and Grouplet."""

    def __init__(self, recipe: Recipe, data: TrainingData, device: torch.device) -> None:
        self.recipe, self.data, self.device = recipe, data, device
        self.both_statistics = {kind: _statistics(data, kind) for kind in ("ward", "labcd")}
        self.statistics = self.both_statistics[recipe.parameters]
        self.objective = Objective(recipe, self.statistics, device)
        packed = PackedScenes.of(data.training).to(device)
        self.drawer = SceneDrawer(packed, recipe.augmentation)

    @cached_property
    def validation(self) -> Validation:
        """Made by the process that needs it."""
        return Validation(self.data.validation, self.recipe, self.statistics, self.device)

    def make(self) -> torch.nn.Module:
        """The recipe's network."""
        return NETWORKS[self.recipe.network].make().to(self.device)

    def batches(self, first: int, parts: Sequence[int]) -> Iterator[Batch]:
        """See :func:`~reflest_core.training.surface.batches.batches`."""
        return batches(self.drawer, self.recipe, first, parts)

    def loss(self, network: torch.nn.Module, batch: Batch) -> torch.Tensor:
        """J (Eq. 3); products in the recipe's precision, the loss always in float32."""
        reduced = self.recipe.precision == "bfloat16"
        with torch.autocast(self.device.type, torch.bfloat16, enabled=reduced):
            scores = network(*batch.inputs)
        return self.objective(scores.float(), batch)

    def rmse(self, module: torch.nn.Module) -> float:
        """In the parameters that the network is trained on."""
        return self.validation.rmse(module)

    def save(self, best: Weights, folder: RunFolder) -> None:
        """The same weights unquantised stand beside the file as ``<name>-float32.safetensors``."""
        card = WeightsCard(
            self.recipe.network,
            self.recipe.parameters,
            WardVariant.WARD_1992,
            self.both_statistics,
            {**self.recipe.describe(), "data": self.data.described},
        )
        exact = folder.path / f"{folder.name}-float32.safetensors"
        save_weights(exact, best, card, eight_bit=False)
        save_weights(folder.weights, best, card, EIGHT_BIT[self.recipe.network])


def _statistics(data: TrainingData, kind: str) -> ParameterStatistics:
    return ParameterStatistics.of(np.stack([s.parameters(kind) for s in data.training]))
