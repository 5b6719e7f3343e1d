# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Checkpoints: a killed training goes on where it was and ends with the same weights."""

from __future__ import annotations

import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from reflest_core.models.recipe import Recipe
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.weight_average import Weights
from reflest_core.whole_file import whole_file


@dataclass
class Checkpoint:
    """The state of a training.

    Attributes:
        minibatch: How many minibatches are done.
        module: The weights.
        optimiser: The optimiser's state.
        average: The running mean of the weights.
        best: The running mean that had the lowest validation RMSE.
        best_rmse: That RMSE.
    """

    minibatch: int
    module: Weights
    optimiser: dict[str, Any]
    average: Weights
    best: Weights
    best_rmse: float


def save_checkpoint(path: Path, checkpoint: Checkpoint, recipe: Recipe) -> None:
    """Write a checkpoint, whole or not at all.

    Args:
        path: Of the file.
        checkpoint: The state to keep.
        recipe: The training's.

    Raises:
        OutputError: It cannot be written; the checkpoint before it is as it was.
    """
    with whole_file(path) as file:
        torch.save({**vars(checkpoint), "recipe": recipe.describe()}, file)


def load_checkpoint(path: Path, recipe: Recipe, device: torch.device) -> Checkpoint | None:
    """Read a checkpoint.

    Args:
        path: Of its file.
        recipe: The training's, which the checkpoint's must equal.
        device: Where its tensors go.

    Returns:
        The checkpoint; None where there is no file.

    Raises:
        TrainingError: The file is damaged or of another recipe.
    """
    if not path.exists():
        return None
    try:
        stored = torch.load(path, weights_only=True, map_location=device)
    except (RuntimeError, EOFError, OSError, pickle.UnpicklingError) as error:
        raise TrainingError(f"{path} is damaged ({error}); delete it to start again") from error
    if stored.pop("recipe") != recipe.describe():
        raise TrainingError(f"{path} belongs to another recipe; use another --out or delete it")
    return Checkpoint(**stored)
