# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The training loop: minibatches in, weight file out; resumable, logged, atomic."""

from __future__ import annotations

import copy
import time
from pathlib import Path
from typing import Generic, TypeVar

import numpy as np
import torch
from torch.nn.parallel import DistributedDataParallel
from tqdm import tqdm

from reflest_core.training.checkpoint import Checkpoint, load_checkpoint, save_checkpoint
from reflest_core.training.processes import Processes
from reflest_core.training.starting_weights import StartingWeights
from reflest_core.training.task import RunFolder, TrainingTask
from reflest_core.training.training_log import Entry, TrainingLog
from reflest_core.training.weight_average import WeightAverage

B = TypeVar("B")


class Trainer(Generic[B]):
    """Trains one task in one folder, alone or as one of several processes."""

    def __init__(
        self,
        task: TrainingTask[B],
        folder: RunFolder,
        processes: Processes,
        start: StartingWeights | None = None,
    ) -> None:
        """Make the network and its optimiser.

        Args:
            task: What is trained.
            folder: Where.
            processes: Those that train together.
            start: Weights to begin from; None begins from random ones.
        """
        torch.manual_seed(task.recipe.seed)
        folder.path.mkdir(parents=True, exist_ok=True)
        self.task, self.folder, self.processes = task, folder, processes
        self.recipe = task.recipe
        self.module = task.make()
        if start is not None:
            start.put_into(self.module, self.recipe)
        _freeze_others(self.module, self.recipe.only)
        self.optimiser = self.recipe.make_optimiser(self.module)
        if processes.is_first:
            self.log = TrainingLog(folder.path, folder.tensorboard)

    def run(self) -> Path:
        """Train from the folder's checkpoint to the end.

        Returns:
            Path of the weight file.
        """
        state = self._resume()
        device = self.processes.device
        started_from = {name: tensor.to(device) for name, tensor in state.average.items()}
        average = WeightAverage(started_from, self.recipe.average)
        network = self.module
        if self.processes.count > 1:
            network = DistributedDataParallel(self.module)
        parts = self.processes.parts(self.recipe.parts)
        quiet = not self.processes.is_first
        bar = tqdm(
            total=self.recipe.minibatches, initial=state.minibatch, unit="batch", disable=quiet
        )
        losses: list[torch.Tensor] = []
        started = time.monotonic()
        for batch in self.task.batches(state.minibatch, parts):
            losses.append(self._step(network, batch, state.minibatch))
            state.minibatch += 1
            average.update(self.module.state_dict(), state.minibatch)
            bar.update()
            if self.processes.is_first and self._is_due(state.minibatch):
                rate = len(losses) / (time.monotonic() - started)
                self._validate(state, average, torch.stack(losses).mean().item(), rate)
                bar.set_postfix(best=f"{state.best_rmse:.3f}")
                losses, started = [], time.monotonic()
        bar.close()
        if self.processes.is_first:
            self.task.save(state.best, self.folder)
        return self.folder.weights

    def _is_due(self, minibatch: int) -> bool:
        every = self.folder.validate_every
        return minibatch % every == 0 or minibatch == self.recipe.minibatches

    def _resume(self) -> Checkpoint:
        path = self.folder.path / "checkpoint.pt"
        found = load_checkpoint(path, self.recipe, torch.device("cpu"))
        if found is None:
            weights = copy.deepcopy(self.module.state_dict())
            optimiser = self.optimiser.state_dict()
            return Checkpoint(0, weights, optimiser, weights, weights, float("inf"))
        self.module.load_state_dict(found.module)
        self.optimiser.load_state_dict(found.optimiser)
        return found

    def _step(self, network: torch.nn.Module, batch: B, minibatch: int) -> torch.Tensor:
        for group in self.optimiser.param_groups:
            group["lr"] = self.recipe.learning_rate_at(minibatch)
        self.optimiser.zero_grad()
        torch.manual_seed(self._seed_of(minibatch))
        loss = self.task.loss(network, batch)
        loss.backward()  # type: ignore[no-untyped-call]
        if self.recipe.largest_gradient > 0:
            weights = self.module.parameters()
            torch.nn.utils.clip_grad_norm_(weights, self.recipe.largest_gradient)
        self.optimiser.step()
        return loss.detach()

    def _seed_of(self, minibatch: int) -> int:
        """Of what a network leaves to chance, so that a resumed training does as a whole one."""
        numbers = [self.recipe.seed, minibatch, self.processes.rank]
        return int(np.random.SeedSequence(numbers).generate_state(1)[0])

    def _validate(
        self, state: Checkpoint, average: WeightAverage, loss: float, rate: float
    ) -> None:
        """Measure the mean weights, keep the best of them, log, and save a checkpoint."""
        measured = self.task.make()
        measured.load_state_dict(average.mean)
        measured.eval()
        rmse = self.task.rmse(measured)
        state.module, state.optimiser = self.module.state_dict(), self.optimiser.state_dict()
        state.average = average.mean
        if rmse < state.best_rmse:
            state.best_rmse, state.best = rmse, copy.deepcopy(average.mean)
        learning_rate = self.recipe.learning_rate_at(state.minibatch - 1)
        self.log.write(Entry(state.minibatch, loss, rmse, learning_rate, rate))
        save_checkpoint(self.folder.path / "checkpoint.pt", state, self.recipe)


def _freeze_others(module: torch.nn.Module, prefix: str) -> None:
    """Keep all tensors whose names do not begin with ``prefix``, running means included."""
    for name, part in module.named_modules():
        if name and not name.startswith(prefix):
            part.eval()
    for name, weight in module.named_parameters():
        weight.requires_grad_(name.startswith(prefix))
