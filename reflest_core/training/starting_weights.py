# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Weights of an earlier training to begin from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import torch

from reflest_core.models.recipe import Recipe
from reflest_core.models.registry import network_named
from reflest_core.models.weights import Tensors, check_fits, load_weights
from reflest_core.training.data.sample import TrainingError

LAST_LAYER = 2
"""A matrix and its bias: the last ones of a network's tensors."""


@dataclass(frozen=True)
class StartingWeights:
    """Weights to begin from.

    Attributes:
        tensors: By name.
        parameters: What the outputs mean, ``ward`` or ``labcd``.
        name: The file's name and hash, for the card.
    """

    tensors: Tensors
    parameters: str
    name: str

    @staticmethod
    def read(path: Path, recipe: Recipe) -> StartingWeights:
        """Read a weight file.

        Args:
            path: Of the file.
            recipe: Of the training that begins with them.

        Raises:
            TrainingError: It holds another network than the recipe's.
        """
        tensors, card, digest = load_weights(path)
        if card.network != recipe.network:
            raise TrainingError(
                f"{path} holds weights of {card.network}, from which {recipe.network} cannot "
                "start; give --from weights of the network that is trained"
            )
        return StartingWeights(tensors, card.parameters, f"{path.stem} {digest}")

    def put_into(self, module: torch.nn.Module, recipe: Recipe) -> None:
        """Copy the weights into a module.

        The last layer keeps its own weights where the recipe's outputs mean something else, and so
        do tensors that the file's version of the network did not have.

        Args:
            module: The network.
            recipe: Of the training that begins with them.
        """
        own = module.state_dict()
        completed = network_named(recipe.network).completed(self.tensors)
        check_fits(completed, {n: tuple(t.shape) for n, t in own.items()}, Path(self.name))
        kept = list(own) if self.parameters == recipe.parameters else list(own)[:-LAST_LAYER]
        for name in kept:
            if name in self.tensors:
                own[name].copy_(torch.from_numpy(self.tensors[name]))
