# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""HemiCNN: a siamese CNN over voxel hemisphere images (section 3.3.1, Figure 3)."""

from __future__ import annotations

import torch
from torch import nn

from reflest_core.brdf.parameters import PARAMETERS


class HemiCNN(nn.Module):
    """(B, N, 3, 10, 10) colours in [0, 1] to (B, 5) z-scored parameters; 14,293 weights."""

    def __init__(self) -> None:
        super().__init__()
        self.conv1 = nn.Conv2d(3, 16, 3)
        self.conv2 = nn.Conv2d(16, 16, 3)
        self.pool = nn.MaxPool2d(2)
        self.fc1 = nn.Linear(16 * 3 * 3, 64)
        self.fc2 = nn.Linear(64, 32)
        self.fc3 = nn.Linear(32, len(PARAMETERS))

    def forward(self, images: torch.Tensor) -> torch.Tensor:
        """Describe each voxel, keep the largest response over voxels, regress.

        Args:
            images: (B, N, 3, 10, 10), colours in [0, 1].
        """
        batch, voxels = images.shape[:2]
        x = images.flatten(0, 1)
        x = torch.relu(self.conv1(x))
        x = torch.relu(self.conv2(x))
        x = self.fc1(self.pool(x).flatten(1))
        merged = x.view(batch, voxels, -1).amax(dim=1)
        parameters: torch.Tensor = self.fc3(torch.tanh(self.fc2(merged)))
        return parameters
