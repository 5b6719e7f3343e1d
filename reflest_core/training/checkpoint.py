# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Checkpoints: a killed training goes on where it was and ends with the same weights."""

from __future__ import annotations

import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from reflest_core.training.data.sample import TrainingError
from reflest_core.training.recipe import Recipe
from reflest_core.training.weight_average import Weights
from reflest_core.whole_file import whole_file


@dataclass
class Checkpoint:
    """``minibatch``: how many are done. ``average``: the running mean of the weights.

    ``best``: the running mean that had the lowest validation RMSE, ``best_rmse``.
    """

    minibatch: int
    module: Weights
    optimiser: dict[str, Any]
    average: Weights
    best: Weights
    best_rmse: float


def save_checkpoint(path: Path, checkpoint: Checkpoint, recipe: Recipe) -> None:
    """Write the checkpoint whole or not at all.

    Raises:
        OutputError: It cannot be written; the checkpoint before it is as it was.
    """
    with whole_file(path) as file:
        torch.save({**vars(checkpoint), "recipe": recipe.describe()}, file)


def load_checkpoint(path: Path, recipe: Recipe, device: torch.device) -> Checkpoint | None:
    """The checkpoint at ``path``, or None; :class:`TrainingError` if it is of another recipe."""
    if not path.exists():
        return None
    try:
        stored = torch.load(path, weights_only=True, map_location=device)
    except (RuntimeError, EOFError, OSError, pickle.UnpicklingError) as error:
        raise TrainingError(f"{path} is damaged ({error}); delete it to start again") from error
    if stored.pop("recipe") != recipe.describe():
        raise TrainingError(f"{path} belongs to another recipe; use another --out or delete it")
    return Checkpoint(**stored)
