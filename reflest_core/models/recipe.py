# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How a network is trained: everything that, with the data, decides its weights."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import torch

WEIGHT_DECAY = 0.03
"""Of ``adamw``: what a weight loses in a minibatch, in units of the learning rate."""


@dataclass(frozen=True)
class Augmentation:
    """How training scenes are varied; the world also always turns about the vertical.

    Attributes:
        views: Least and most views kept of a scene.
        candidates: Random voxels from which those of a minibatch are chosen.
        spread: Choose them as an estimate does, else at random.
        azimuth: Radians; hemisphere images turn by up to this either way.
        channel_swap: Permute the colour channels of light and material alike.
    """

    views: tuple[int, int] = (5, 100)
    candidates: int = 120
    spread: bool = True
    azimuth: float = math.pi / 6
    channel_swap: bool = True


@dataclass(frozen=True)
class Recipe:
    """Loss, optimiser and data of one training.

    Attributes:
        network: Name of the network.
        loss: ``rmse1``, ``rmse2`` or ``cuberoot`` (Table 1); ``likelihood`` is lightnet's.
        optimiser: ``adam``, ``adamw``, ``rmsprop`` or ``sgd``.
        learning_rate: The greatest. It rises over ``warm_up`` minibatches, then holds for the share
            ``hold`` of all, then falls as a cosine to 0.
        momentum: Of ``rmsprop`` and ``sgd``.
        minibatches: Of the whole training.
        batch_size: Scenes in each of the ``parts`` of a minibatch.
        voxels: Of one scene in a minibatch.
        validation_voxels: Of one scene in validation, as many as an estimate's.
        colour_constancy: lambda of E_c (Eq. 4).
        nodes_per_voxel: Grouplet's, in a minibatch; fewer than an estimate's 10 train faster.
        warm_up: Minibatches; see ``learning_rate``.
        hold: Share of all minibatches; see ``learning_rate``.
        average: Decay of the running mean of the weights that is shipped; 0 ships the last weights.
        precision: ``float32`` or ``bfloat16``, of matrix products.
        parts: Parts of a minibatch, which processes share.
        seed: Of everything random.
        observations: Of one voxel in a minibatch of lightnet; 0 takes all.
        without: Parts of lightnet that it is trained without.
        hold_out: Environments that lightnet never sees in training, so that it can be measured and
            calibrated on them.
        largest_gradient: Longer gradients are shortened to it; 0 leaves them.
        start: The weights that training begins from, by name and hash.
        only: Train only tensors whose names begin so; empty trains all.
        augmentation: How scenes are varied.
    """

    network: str
    loss: str
    optimiser: str
    learning_rate: float
    momentum: float
    minibatches: int
    batch_size: int
    voxels: int
    validation_voxels: int
    colour_constancy: float = 0.0
    nodes_per_voxel: int = 5
    warm_up: int = 0
    hold: float = 1.0
    average: float = 0.0
    precision: str = "float32"
    parts: int = 1
    seed: int = 1
    observations: int = 0
    without: tuple[str, ...] = ()
    hold_out: tuple[str, ...] = ()
    largest_gradient: float = 0.0
    start: str = ""
    only: str = ""
    augmentation: Augmentation = field(default_factory=Augmentation)

    @property
    def parameters(self) -> str:
        """The parameterisation that the loss is written in."""
        return "labcd" if self.loss == "rmse2" else "ward"

    def make_optimiser(self, module: torch.nn.Module) -> torch.optim.Optimizer:
        """Make the optimiser of a module's weights, with the recipe's learning rate.

        Args:
            module: The network.
        """
        import torch

        weights, rate = module.parameters(), self.learning_rate
        if self.optimiser == "adam":
            return torch.optim.Adam(weights, lr=rate)
        if self.optimiser == "adamw":
            return torch.optim.AdamW(weights, lr=rate, weight_decay=WEIGHT_DECAY)
        if self.optimiser == "rmsprop":
            return torch.optim.RMSprop(weights, lr=rate, momentum=self.momentum)
        return torch.optim.SGD(weights, lr=rate, momentum=self.momentum)

    def learning_rate_at(self, minibatch: int) -> float:
        """Return the learning rate of a minibatch, counted from 0.

        Args:
            minibatch: Its number, from 0.
        """
        if minibatch < self.warm_up:
            return self.learning_rate * (minibatch + 1) / (self.warm_up + 1)
        held = max(self.hold * self.minibatches, self.warm_up)
        falling = max(self.minibatches - held, 1)
        progress = min(max(minibatch - held, 0) / falling, 1.0)
        return self.learning_rate * (1 + math.cos(math.pi * progress)) / 2

    def describe(self) -> dict[str, Any]:
        """Return JSON values for the weight file's card."""
        return dataclasses.asdict(self)
