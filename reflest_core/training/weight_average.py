# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A running mean of the weights: steadier than the last ones, at no cost to the estimate."""

from __future__ import annotations

import torch

Weights = dict[str, torch.Tensor]


class WeightAverage:
    """Exponential running mean of weights.

    Attributes:
        decay: Share of the mean that stays at each minibatch; 0 follows the weights themselves.
        mean: The mean, by name.
    """

    def __init__(self, weights: Weights, decay: float) -> None:
        """Begin with the given weights.

        Args:
            weights: By name.
            decay: Share of the mean that stays at each minibatch.
        """
        self.decay = decay
        self.mean = {name: tensor.detach().clone() for name, tensor in weights.items()}

    def update(self, weights: Weights, minibatch: int) -> None:
        """Add the weights after ``minibatch`` minibatches; early ones are soon forgotten.

        Args:
            weights: By name.
            minibatch: How many are done.
        """
        decay = min(self.decay, minibatch / (minibatch + 10))
        names = list(self.mean)
        torch._foreach_lerp_(
            [self.mean[name] for name in names],
            [weights[name].detach() for name in names],
            1 - decay,
        )
