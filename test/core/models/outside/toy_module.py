# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The toy network's PyTorch module."""

import torch


class Toy(torch.nn.Module):
    def __init__(self):
        super().__init__()
        self.layer = torch.nn.Linear(3, 5)

    def forward(self, colours):
        return self.layer(colours.mean(dim=1))
