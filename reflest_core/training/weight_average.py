# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A running mean of the weights: steadier than the last ones, at no cost to the estimate."""

from __future__ import annotations

import torch

Weights = dict[str, torch.Tensor]


class WeightAverage:
    """Exponential running mean with the given ``decay``; 0 follows the weights themselves."""

    def __init__(self, weights: Weights, decay: float) -> None:
        self.decay = decay
        self.mean = {name: tensor.detach().clone() for name, tensor in weights.items()}

    def update(self, weights: Weights, minibatch: int) -> None:
        """Take in the weights after ``minibatch`` minibatches; the first ones count for little."""
        decay = min(self.decay, minibatch / (minibatch + 10))
        names = list(self.mean)
        torch._foreach_lerp_(
            [self.mean[name] for name in names],
            [weights[name].detach() for name in names],
            1 - decay,
        )
