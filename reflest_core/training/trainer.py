# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The training loop: minibatches in, weight file out; resumable, logged, atomic."""

from __future__ import annotations

import copy
import dataclasses
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch.nn.parallel import DistributedDataParallel
from tqdm import tqdm

from reflest_core.brdf.parameters import WardVariant
from reflest_core.models.network_kind import NETWORKS
from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.models.weights import WeightsCard, save_weights
from reflest_core.training.batches import Batch, batches
from reflest_core.training.checkpoint import Checkpoint, load_checkpoint, save_checkpoint
from reflest_core.training.data import TrainingData
from reflest_core.training.drawn_scenes import SceneDrawer
from reflest_core.training.objective import Objective
from reflest_core.training.packed_scenes import PackedScenes
from reflest_core.training.processes import Processes
from reflest_core.training.recipe import Recipe
from reflest_core.training.starting_weights import StartingWeights
from reflest_core.training.training_log import Entry, TrainingLog
from reflest_core.training.validation import Validation
from reflest_core.training.weight_average import WeightAverage

EIGHT_BIT = {"hemicnn": False, "grouplet": True}
"""Grouplet meets the paper's size only in 8 bits (SPEC, Grouplet)."""


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


class Trainer:
    """Trains one network by one recipe in one folder, alone or as one of several processes."""

    def __init__(
        self,
        recipe: Recipe,
        data: TrainingData,
        folder: RunFolder,
        processes: Processes,
        start: StartingWeights | None = None,
    ) -> None:
        torch.manual_seed(recipe.seed)
        folder.path.mkdir(parents=True, exist_ok=True)
        if start is not None:
            recipe = dataclasses.replace(recipe, start=start.name)
        self.recipe, self.data, self.folder, self.processes = recipe, data, folder, processes
        device = processes.device
        self.both_statistics = {kind: _statistics(data, kind) for kind in ("ward", "labcd")}
        self.statistics = self.both_statistics[recipe.parameters]
        self.objective = Objective(recipe, self.statistics, device)
        self.module = NETWORKS[recipe.network].make().to(device)
        if start is not None:
            start.put_into(self.module, recipe)
        self.optimiser = recipe.make_optimiser(self.module)
        packed = PackedScenes.of(data.training).to(device)
        self.drawer = SceneDrawer(packed, recipe.augmentation)
        if processes.is_first:
            self.validation = Validation(data.validation, recipe, self.statistics, device)
            self.log = TrainingLog(folder.path, folder.tensorboard)

    def run(self) -> Path:
        """Train on from the folder's checkpoint to the end; return the weight file.

        The same weights unquantised stand beside it as ``<name>-float32.safetensors``.
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
        for batch in batches(self.drawer, self.recipe, state.minibatch, parts):
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
        return self._write_weights(state) if self.processes.is_first else self.folder.weights

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

    def _step(self, network: torch.nn.Module, batch: Batch, minibatch: int) -> torch.Tensor:
        for group in self.optimiser.param_groups:
            group["lr"] = self.recipe.learning_rate_at(minibatch)
        self.optimiser.zero_grad()
        reduced = self.recipe.precision == "bfloat16"
        with torch.autocast(self.processes.device.type, torch.bfloat16, enabled=reduced):
            scores = network(*batch.inputs)
        loss = self.objective(scores.float(), batch)
        loss.backward()  # type: ignore[no-untyped-call]
        self.optimiser.step()
        return loss.detach()

    def _validate(
        self, state: Checkpoint, average: WeightAverage, loss: float, rate: float
    ) -> None:
        """Measure the mean weights, keep the best of them, log, and save a checkpoint."""
        measured = NETWORKS[self.recipe.network].make().to(self.processes.device)
        measured.load_state_dict(average.mean)
        rmse = self.validation.rmse(measured)
        state.module, state.optimiser = self.module.state_dict(), self.optimiser.state_dict()
        state.average = average.mean
        if rmse < state.best_rmse:
            state.best_rmse, state.best = rmse, copy.deepcopy(average.mean)
        learning_rate = self.recipe.learning_rate_at(state.minibatch - 1)
        self.log.write(Entry(state.minibatch, loss, rmse, learning_rate, rate))
        save_checkpoint(self.folder.path / "checkpoint.pt", state, self.recipe)

    def _write_weights(self, state: Checkpoint) -> Path:
        recipe = {**self.recipe.describe(), "data": self.data.described}
        card = WeightsCard(
            self.recipe.network,
            self.recipe.parameters,
            WardVariant.WARD_1992,
            self.both_statistics,
            recipe,
        )
        exact = self.folder.path / f"{self.folder.name}-float32.safetensors"
        save_weights(exact, state.best, card, eight_bit=False)
        save_weights(self.folder.weights, state.best, card, EIGHT_BIT[self.recipe.network])
        return self.folder.weights


def _statistics(data: TrainingData, kind: str) -> ParameterStatistics:
    return ParameterStatistics.of(np.stack([s.parameters(kind) for s in data.training]))
