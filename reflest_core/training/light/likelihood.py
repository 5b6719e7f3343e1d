# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The loss of ``lightnet``: a Gaussian likelihood that does not give up on hard scenes."""

from __future__ import annotations

import torch

LOG_VARIANCES = (-7.0, 3.0)
BETA = 0.5
"""Seitzer et al. 2022, "On the Pitfalls of Heteroscedastic Uncertainty Estimation": each term is
weighted by its variance to this power, so that uncertain scenes keep their say in the mean."""
SQUARED_SHARE = 0.25
"""Weight of the plain squared error beside it."""


def likelihood_loss(
    means: torch.Tensor, log_variances: torch.Tensor, truth: torch.Tensor
) -> torch.Tensor:
    """Mean over (B, 5) z-scored parameters."""
    log_variances = log_variances.clamp(*LOG_VARIANCES)
    squared = (means - truth) ** 2
    negative_log = 0.5 * (log_variances + squared * torch.exp(-log_variances))
    weight = torch.exp(BETA * log_variances.detach())
    return (weight * negative_log).mean() + SQUARED_SHARE * squared.mean()
