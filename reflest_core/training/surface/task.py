# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training of a network that sees the surface, and F and B, alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np
import torch

from reflest_core.brdf.parameters import WardVariant
from reflest_core.models.card import ParameterStatistics, WeightsCard
from reflest_core.models.minibatch import PackedScenes
from reflest_core.models.recipe import Recipe
from reflest_core.models.registry import network_named
from reflest_core.models.weights import save_weights
from reflest_core.training.data.sample_sets import TrainingData
from reflest_core.training.surface.batches import Batch, batches
from reflest_core.training.surface.drawn_scenes import SceneDrawer
from reflest_core.training.surface.objective import Objective
from reflest_core.training.surface.validation import Validation
from reflest_core.training.task import RunFolder
from reflest_core.training.weight_average import Weights


class SurfaceTask:
    """A :class:`~reflest_core.training.task.TrainingTask` for networks of the surface."""

    def __init__(self, recipe: Recipe, data: TrainingData, device: torch.device) -> None:
        """Pack the scenes onto the device.

        Args:
            recipe: The training's.
            data: Its scenes.
            device: Where it is trained.
        """
        self.recipe, self.data, self.device = recipe, data, device
        self.both_statistics = {kind: _statistics(data, kind) for kind in ("ward", "labcd")}
        self.statistics = self.both_statistics[recipe.parameters]
        self.objective = Objective(recipe, self.statistics, device)
        self.definition = network_named(recipe.network)
        ward = np.stack([sample.ward for sample in data.training])
        packed = PackedScenes.of([sample.surface for sample in data.training], ward).to(device)
        self.drawer = SceneDrawer(packed, recipe.augmentation)

    @cached_property
    def validation(self) -> Validation:
        """The validation scenes, prepared by the process that needs them."""
        return Validation(self.data.validation, self.recipe, self.statistics, self.device)

    @property
    def examples(self) -> int:
        """How many training scenes there are."""
        return len(self.data.training)

    def make(self) -> torch.nn.Module:
        """Make the recipe's network, untrained."""
        return self.definition.module().to(self.device)

    def batches(self, first: int, parts: Sequence[int]) -> Iterator[Batch]:
        """Draw minibatches; see :func:`~reflest_core.training.surface.batches.batches`.

        Args:
            first: Number of the first minibatch.
            parts: Which parts of each minibatch.
        """
        return batches(self.drawer, self.recipe, first, parts)

    def loss(self, network: torch.nn.Module, batch: Batch) -> torch.Tensor:
        """Compute J (Eq. 3): products in the recipe's precision, the loss in float32.

        Args:
            network: The network.
            batch: The minibatch.
        """
        reduced = self.recipe.precision == "bfloat16"
        with torch.autocast(self.device.type, torch.bfloat16, enabled=reduced):
            scores = network(*batch.inputs)
        return self.objective(scores.float(), batch)

    def rmse(self, module: torch.nn.Module) -> float:
        """Measure it in the parameters that the network is trained on.

        Args:
            module: The network.
        """
        return self.validation.rmse(module)

    def save(self, best: Weights, folder: RunFolder) -> None:
        """Write the weight file and, unquantised, ``<name>-float32.safetensors`` beside it.

        Args:
            best: The weights to keep.
            folder: The training's.
        """
        card = WeightsCard(
            self.recipe.network,
            self.recipe.parameters,
            WardVariant.WARD_1992,
            self.both_statistics,
            {**self.recipe.describe(), "data": self.data.described},
        )
        exact = folder.path / f"{folder.name}-float32.safetensors"
        save_weights(exact, best, card, eight_bit=False)
        save_weights(folder.weights, best, card, self.definition.eight_bit)


def _statistics(data: TrainingData, kind: str) -> ParameterStatistics:
    return ParameterStatistics.of(np.stack([s.parameters(kind) for s in data.training]))
