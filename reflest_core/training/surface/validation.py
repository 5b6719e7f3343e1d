# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Validation while training: features are built once, in the live path's own code."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.models.card import ParameterStatistics
from reflest_core.models.recipe import Recipe
from reflest_core.models.registry import network_named
from reflest_core.surface.voxel_choice import choose_voxels
from reflest_core.training.data.sample import Sample
from reflest_core.training.metrics import normalised_rmse

Inputs = tuple[torch.Tensor, ...]
GROUPED = 16
"""Scenes with inputs of one shape that pass the network at once."""


class Validation:
    """The validation scenes as a network's inputs, on the training device.

    Attributes:
        truths: (S, 5) true parameters, in those that the network is trained on.
    """

    def __init__(
        self,
        samples: list[Sample],
        recipe: Recipe,
        statistics: ParameterStatistics,
        device: torch.device,
    ) -> None:
        """Build the features of every sample.

        Args:
            samples: The S validation scenes.
            recipe: The training's.
            statistics: The training set's, of the parameters that the network is trained on.
            device: Where the network is.
        """
        self.statistics = statistics
        self.inputs = [_features(sample, recipe, device) for sample in samples]
        self.truths = np.stack([sample.parameters(recipe.parameters) for sample in samples])
        self.groups = _groups(self.inputs)

    def rmse(self, module: torch.nn.Module) -> float:
        """Measure the network's normalised RMSE, in the parameters that it is trained on.

        Args:
            module: The network.
        """
        return normalised_rmse(self.predict(module), self.truths, self.statistics).overall

    def predict(self, module: torch.nn.Module) -> NDArray[np.float64]:
        """Estimate (S, 5) parameters.

        Args:
            module: The network.
        """
        scores = np.empty(self.truths.shape)
        with torch.inference_mode():
            for group in self.groups:
                columns = zip(*(self.inputs[index] for index in group), strict=True)
                batch = [torch.stack(column) for column in columns]
                scores[group] = module(*batch).double().cpu().numpy()
        return self.statistics.restore(scores)


def _features(sample: Sample, recipe: Recipe, device: torch.device) -> Inputs:
    voxels = choose_voxels(sample.surface, recipe.validation_voxels)
    features = network_named(recipe.network).features(sample.surface, voxels)
    return tuple(torch.from_numpy(values).to(device) for values in features)


def _groups(inputs: list[Inputs]) -> list[list[int]]:
    """Scenes by the shape of their inputs, at most :data:`GROUPED` together."""
    by_shape: dict[tuple[int, ...], list[int]] = {}
    for index, tensors in enumerate(inputs):
        by_shape.setdefault(tuple(tensors[0].shape), []).append(index)
    return [
        alike[first : first + GROUPED]
        for alike in by_shape.values()
        for first in range(0, len(alike), GROUPED)
    ]
