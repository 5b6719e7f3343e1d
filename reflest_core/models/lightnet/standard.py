# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Inputs in standard units: their mean and spread are learned as they pass by."""

from __future__ import annotations

import torch
from torch import nn

from reflest_core.models.lightnet.live import FURTHEST

MOMENTUM = 0.01


class Standard(nn.Module):
    """(..., N) to the same less the mean, over the standard deviation, within +-4.

    While training, running means over the minibatches; unlike batch normalisation the same
    numbers are used in training and afterwards.
    """

    mean: torch.Tensor
    variance: torch.Tensor
    seen: torch.Tensor

    def __init__(self, inputs: int) -> None:
        super().__init__()
        self.register_buffer("mean", torch.zeros(inputs))
        self.register_buffer("variance", torch.ones(inputs))
        self.register_buffer("seen", torch.zeros(1))

    def forward(self, values: torch.Tensor) -> torch.Tensor:
        """Standard scores of ``values``."""
        if self.training:
            self._follow(values.detach().flatten(0, -2))
        scores = (values - self.mean) / torch.sqrt(self.variance + 1e-4)
        return scores.clamp(-FURTHEST, FURTHEST)

    def _follow(self, values: torch.Tensor) -> None:
        share = max(MOMENTUM, 1.0 / (float(self.seen) + 1.0))
        offset = values.mean(dim=0) - self.mean
        spread = values.var(dim=0, unbiased=False) + (1.0 - share) * offset**2
        self.mean += share * offset
        self.variance += share * (spread - self.variance)
        self.seen += 1.0
