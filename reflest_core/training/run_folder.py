# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The folder of one training."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class RunFolder:
    """Where one training keeps its checkpoint, log and weights, ``<name>.safetensors``."""

    path: Path
    name: str
    validate_every: int = 1000
    tensorboard: bool = False

    @property
    def weights(self) -> Path:
        """The weight file that a finished training leaves."""
        return self.path / f"{self.name}.safetensors"
