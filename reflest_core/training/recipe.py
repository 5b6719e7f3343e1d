# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How a network is trained: everything that, with the data, decides its weights."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from reflest_core.training.data.augmentation import Augmentation

if TYPE_CHECKING:
    import torch

OPTIMISERS = ("adam", "adamw", "rmsprop", "sgd")
WEIGHT_DECAY = 0.03
"""Of ``adamw``: what a weight loses in a minibatch, in units of the learning rate."""


@dataclass(frozen=True)
class Recipe:
    """Loss, optimiser and data of one training.

    ``loss``: ``rmse1``, ``rmse2`` or ``cuberoot`` (Table 1); ``likelihood`` is ``lightnet``'s.
    ``colour_constancy``: lambda of E_c.
    ``optimiser``: one of :data:`OPTIMISERS`; ``momentum`` counts for the last two. The learning
    rate rises over ``warm_up`` minibatches, then holds for the share ``hold`` of all, then falls
    as a cosine to 0. ``batch_size``: scenes in each of the ``parts`` of a minibatch, which
    processes share. ``voxels``, ``nodes_per_voxel``: of one scene in a minibatch; fewer nodes than
    an estimate's 10 train faster. ``average``: decay of the running mean of the weights that is
    shipped; 0 ships the last. ``precision``: ``float32`` or ``bfloat16`` of matrix products.
    ``validation_voxels``: of one scene in validation, as many as an estimate's.
    ``observations``: of one voxel in a minibatch, ``lightnet``'s alone; 0 takes all. ``without``:
    what ``lightnet`` is trained without (:mod:`.light.ablation`). ``hold_out``: environments that
    it never sees, so that it can be measured on them. ``largest_gradient``: longer ones are
    shortened to it; 0 leaves them. ``start``: the weights that training begins from, by name and
    hash.
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
    augmentation: Augmentation = dataclasses.field(default_factory=Augmentation)

    @property
    def parameters(self) -> str:
        """The parameterisation that the loss is written in."""
        return "labcd" if self.loss == "rmse2" else "ward"

    def make_optimiser(self, module: torch.nn.Module) -> torch.optim.Optimizer:
        """The optimiser with its first learning rate."""
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
        """The learning rate of one minibatch."""
        if minibatch < self.warm_up:
            return self.learning_rate * (minibatch + 1) / (self.warm_up + 1)
        held = max(self.hold * self.minibatches, self.warm_up)
        falling = max(self.minibatches - held, 1)
        progress = min(max(minibatch - held, 0) / falling, 1.0)
        return self.learning_rate * (1 + math.cos(math.pi * progress)) / 2

    def describe(self) -> dict[str, Any]:
        """JSON values for the weight file's card."""
        return dataclasses.asdict(self)


PAPER_RECIPES = {
    "hemicnn": Recipe(
        "hemicnn", "rmse1", "rmsprop", 1e-4, 0.0, 100_000, 32, voxels=25, validation_voxels=25
    ),
    "grouplet": Recipe(
        "grouplet", "rmse1", "sgd", 0.01, 0.9, 13_000, 24, voxels=20, validation_voxels=354
    ),
}
"""Section 3.3.2: RMSProp 1e-4 for 100K minibatches; SGD 0.01, momentum 0.9, for 13K."""

RECIPES = {
    "hemicnn": Recipe(
        "hemicnn",
        "rmse1",
        "adam",
        5e-3,
        0.0,
        60_000,
        32,
        voxels=25,
        validation_voxels=25,
        warm_up=500,
        hold=0.0,
        average=0.999,
    ),
    "grouplet": Recipe(
        "grouplet",
        "rmse1",
        "adam",
        1e-3,
        0.0,
        30_000,
        24,
        voxels=64,
        validation_voxels=354,
        warm_up=500,
        hold=0.0,
        average=0.999,
        precision="bfloat16",
        augmentation=Augmentation(spread=False),
    ),
    "lightnet": Recipe(
        "lightnet",
        "likelihood",
        "adamw",
        2e-3,
        0.0,
        6000,
        48,
        voxels=24,
        validation_voxels=48,
        warm_up=500,
        hold=0.0,
        average=0.998,
        observations=6,
        largest_gradient=1.0,
    ),
}
"""Ours: Adam, a rate that falls as a cosine all along, the running mean of the weights."""
