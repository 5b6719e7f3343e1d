# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a training teaches: the part of it that depends on the kind of network."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol, TypeVar

import torch

from reflest_core.training.recipe import Recipe
from reflest_core.training.run_folder import RunFolder
from reflest_core.training.weight_average import Weights

B = TypeVar("B")


class Course(Protocol[B]):
    """Minibatches of type ``B``, the loss, the measure by which weights are chosen.

    ``recipe``: that of the training, which :class:`~reflest_core.training.trainer.Trainer` follows.
    """

    recipe: Recipe

    def make(self) -> torch.nn.Module:
        """The network, untrained, on the training device."""

    def batches(self, first: int, parts: Sequence[int]) -> Iterator[B]:
        """The given ``parts`` of the minibatches from number ``first`` to the recipe's last."""

    def loss(self, network: torch.nn.Module, batch: B) -> torch.Tensor:
        """What is minimised, of one minibatch."""

    def rmse(self, module: torch.nn.Module) -> float:
        """Normalised RMSE on validation; the weights of the lowest are kept."""

    def save(self, best: Weights, folder: RunFolder) -> None:
        """Write the weight file, and what else a finished training leaves."""
