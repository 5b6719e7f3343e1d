# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Grouplet: weak regressors on random observations, pooled by moments (section 3.3.2, Figure 4)."""

from __future__ import annotations

import torch
from torch import nn

from reflest_core.brdf.parameters import PARAMETERS
from reflest_core.models.grouplet.grouplets import BRANCH_INPUTS, BRANCHES


class Grouplet(nn.Module):
    """Nodes of 5 branches to (B, 5) z-scored parameters; 265,989 weights, any number of nodes."""

    def __init__(self) -> None:
        super().__init__()
        self.branch = nn.Sequential(
            nn.Linear(BRANCH_INPUTS, 128), nn.Tanh(), nn.Linear(128, 128), nn.Tanh()
        )
        self.node = nn.Sequential(
            nn.Linear(BRANCHES * 128 + 3, 256), nn.Tanh(), nn.Linear(256, 128), nn.Tanh()
        )
        self.regressor = nn.Sequential(
            nn.Linear(256, 128),
            nn.Tanh(),
            nn.Linear(128, 128),
            nn.Tanh(),
            nn.Linear(128, len(PARAMETERS)),
        )

    def forward(self, branches: torch.Tensor, normals: torch.Tensor) -> torch.Tensor:
        """Estimate (B, 5) z-scored parameters.

        Args:
            branches: (B, G, 5, 12), observations of each node.
            normals: (B, G, 3), normals of the nodes.
        """
        described = self.branch(branches).flatten(2)
        nodes = self.node(torch.cat([described, normals], dim=2))
        moments = torch.cat([nodes.mean(dim=1), nodes.var(dim=1, unbiased=False)], dim=1)
        parameters: torch.Tensor = self.regressor(moments)
        return parameters
