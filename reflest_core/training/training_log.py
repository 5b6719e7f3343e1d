# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A training's log as CSV, and for TensorBoard where it is asked for."""

from __future__ import annotations

import csv
import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reflest_core.training.data.sample import TrainingError


@dataclass(frozen=True)
class Entry:
    """What is logged after a validation.

    Attributes:
        minibatch: How many are done.
        training_loss: Mean of the loss since the last validation.
        validation_rmse: Normalised RMSE on validation.
        learning_rate: Of the last minibatch.
        minibatches_per_second: Since the last validation.
    """

    minibatch: int
    training_loss: float
    validation_rmse: float
    learning_rate: float
    minibatches_per_second: float


class TrainingLog:
    """Appends to ``log.csv``, and to ``tensorboard/`` if ``tensorboard`` is set."""

    def __init__(self, folder: Path, tensorboard: bool) -> None:
        """Open the log.

        Args:
            folder: The training's.
            tensorboard: Also log for TensorBoard.
        """
        self.path = folder / "log.csv"
        self.writer = _summary_writer(folder / "tensorboard") if tensorboard else None

    def write(self, entry: Entry) -> None:
        """Append one line.

        Args:
            entry: What is logged.
        """
        is_new = not self.path.exists()
        with self.path.open("a", newline="") as file:
            columns = csv.writer(file)
            if is_new:
                columns.writerow([field.name for field in dataclasses.fields(entry)])
            columns.writerow([f"{value:.6g}" for value in dataclasses.astuple(entry)])
        if self.writer is not None:
            for name, value in dataclasses.asdict(entry).items():
                if name != "minibatch":
                    self.writer.add_scalar(name, value, entry.minibatch)
            self.writer.flush()


def _summary_writer(folder: Path) -> Any:
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ImportError as error:
        raise TrainingError(
            "TensorBoard is not installed: pip install 'reflest-ros[training]', "
            "or leave --tensorboard out"
        ) from error
    return SummaryWriter(str(folder))
