# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What :class:`~reflest_core.training.trainer.Trainer` trains: data, loss and measure, in a folder.

A *task* is the part of a training that depends on the kind of network.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, TypeVar

import torch

from reflest_core.models.recipe import Recipe
from reflest_core.training.weight_average import Weights

AHEAD = 4
"""Minibatches that are prepared before the optimiser asks for them."""

B = TypeVar("B")
T = TypeVar("T")


@dataclass(frozen=True)
class RunFolder:
    """Where one training keeps its checkpoint, log and weights.

    Attributes:
        path: The folder.
        name: Of the weight file, without its suffix.
        validate_every: Minibatches from one validation to the next.
        tensorboard: Also log for TensorBoard.
    """

    path: Path
    name: str
    validate_every: int = 1000
    tensorboard: bool = False

    @property
    def weights(self) -> Path:
        """The weight file that a finished training leaves."""
        return self.path / f"{self.name}.safetensors"


class TrainingTask(Protocol[B]):
    """Minibatches of type ``B``, the loss, and the measure by which weights are chosen.

    Attributes:
        recipe: The recipe that the training follows.
    """

    recipe: Recipe

    @property
    def examples(self) -> int:
        """How many examples there are to learn from."""

    def make(self) -> torch.nn.Module:
        """Make the untrained network, on the training device."""

    def batches(self, first: int, parts: Sequence[int]) -> Iterator[B]:
        """Draw minibatches.

        Args:
            first: Number of the first minibatch; the recipe's last is the last.
            parts: Which parts of each minibatch this process draws.
        """

    def loss(self, network: torch.nn.Module, batch: B) -> torch.Tensor:
        """Compute what is minimised, of one minibatch.

        Args:
            network: The network.
            batch: The minibatch.
        """

    def rmse(self, module: torch.nn.Module) -> float:
        """Measure the normalised RMSE on validation; the weights of the lowest are kept.

        Args:
            module: The network.
        """

    def save(self, best: Weights, folder: RunFolder) -> None:
        """Write the weight file, and what else a finished training leaves.

        Args:
            best: The weights to keep.
            folder: The training's.
        """


def prepared_ahead(make: Callable[[int], T], numbers: range, device: torch.device) -> Iterator[T]:
    """Call ``make`` for each number, in order, a few ahead of what is asked for.

    Args:
        make: Makes minibatch number n.
        numbers: The minibatches.
        device: On a CPU a second thread prepares them; a GPU's queue of kernels is ahead by itself.
    """
    if device.type != "cpu":
        yield from map(make, numbers)
        return
    with ThreadPoolExecutor(1) as pool:
        waiting: list[Future[T]] = []
        upcoming = iter(numbers)
        for _ in numbers:
            while len(waiting) < AHEAD and (number := next(upcoming, None)) is not None:
                waiting.append(pool.submit(make, number))
            yield waiting.pop(0).result()
