# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training ``lightnet``: resumable, logged, the best mean weights on validation kept."""

from __future__ import annotations

import copy
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.brdf.parameters import WardVariant
from reflest_core.models.lightnet import LightNet
from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.models.weights import WeightsCard, save_weights
from reflest_core.training.checkpoint import Checkpoint, load_checkpoint, save_checkpoint
from reflest_core.training.light.light_batches import varied_looks, whole_looks
from reflest_core.training.light.likelihood import likelihood_loss
from reflest_core.training.light.shading_shards import Shadings
from reflest_core.training.recipe import Recipe
from reflest_core.training.training_log import Entry, TrainingLog
from reflest_core.training.weight_average import WeightAverage

OBSERVATIONS = 8
"""Of a voxel in a minibatch, of the 12 that an estimate sees."""
LARGEST_GRADIENT = 1.0
MEASURED_AT_ONCE = 64

LIGHT_RECIPE = Recipe(
    "lightnet", "likelihood", "adam", 3e-3, 0.0, 30_000, 32, voxels=32, validation_voxels=48,
    warm_up=1000, hold=0.1, average=0.999,
)  # fmt: skip
"""Where to begin: not yet chosen on environments kept from training."""


@dataclass(frozen=True)
class LightData:
    """Looks to train on and to choose weights by; what the card says of them."""

    training: Shadings
    validation: Shadings
    described: dict[str, Any] = field(default_factory=dict)


class LightTrainer:
    """Trains in one folder; a killed run goes on from its last validation."""

    def __init__(
        self, recipe: Recipe, data: LightData, folder: Path, validate_every: int = 1000
    ) -> None:
        torch.manual_seed(recipe.seed)
        folder.mkdir(parents=True, exist_ok=True)
        self.recipe, self.data, self.folder = recipe, data, folder
        self.validate_every = validate_every
        ward = data.training.ward.astype(np.float64)
        labcd = np.stack([ward_to_labcd(one) for one in ward])
        self.both_statistics = {
            "ward": ParameterStatistics.of(ward), "labcd": ParameterStatistics.of(labcd)
        }  # fmt: skip
        self.statistics = self.both_statistics["ward"]
        self.module = LightNet()
        self.optimiser = recipe.make_optimiser(self.module)
        self.log = TrainingLog(folder, tensorboard=False)

    def run(self) -> Path:
        """Train to the end and return the weight file, ``lightnet.safetensors``."""
        state = self._resume()
        average = WeightAverage(state.average, self.recipe.average)
        bar = tqdm(total=self.recipe.minibatches, initial=state.minibatch, unit="batch")
        losses, started = [], time.monotonic()
        while state.minibatch < self.recipe.minibatches:
            losses.append(self._step(state.minibatch))
            state.minibatch += 1
            average.update(self.module.state_dict(), state.minibatch)
            bar.update()
            is_last = state.minibatch == self.recipe.minibatches
            if is_last or state.minibatch % self.validate_every == 0:
                rate = len(losses) / (time.monotonic() - started)
                self._validate(state, average, float(np.mean(losses)), rate)
                bar.set_postfix(best=f"{state.best_rmse:.3f}")
                losses, started = [], time.monotonic()
        bar.close()
        return self._write_weights(state)

    def _step(self, minibatch: int) -> float:
        for group in self.optimiser.param_groups:
            group["lr"] = self.recipe.learning_rate_at(minibatch)
        rng = np.random.default_rng([self.recipe.seed, minibatch])
        rows = rng.integers(len(self.data.training), size=self.recipe.batch_size)
        generator = torch.Generator().manual_seed(int(rng.integers(2**31)))
        look, truth = varied_looks(
            self.data.training, rows, self.recipe.voxels, OBSERVATIONS, generator
        )
        self.optimiser.zero_grad()
        means, log_variances = self.module(**look)
        loss = likelihood_loss(means, log_variances, self._scores(truth))
        loss.backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(self.module.parameters(), LARGEST_GRADIENT)
        self.optimiser.step()
        return float(loss.detach())

    def _scores(self, ward: torch.Tensor) -> torch.Tensor:
        mean, stddev = self.statistics.mean, self.statistics.stddev
        return (ward - torch.from_numpy(mean).float()) / torch.from_numpy(stddev).float()

    def _resume(self) -> Checkpoint:
        path = self.folder / "checkpoint.pt"
        found = load_checkpoint(path, self.recipe, torch.device("cpu"))
        if found is None:
            weights = copy.deepcopy(self.module.state_dict())
            optimiser = self.optimiser.state_dict()
            return Checkpoint(0, weights, optimiser, weights, weights, float("inf"))
        self.module.load_state_dict(found.module)
        self.optimiser.load_state_dict(found.optimiser)
        return found

    def _validate(
        self, state: Checkpoint, average: WeightAverage, loss: float, rate: float
    ) -> None:
        measured = LightNet()
        measured.load_state_dict(average.mean)
        rmse = normalised_rmse(measured, self.data.validation, self.statistics)
        state.module, state.optimiser = self.module.state_dict(), self.optimiser.state_dict()
        state.average = average.mean
        if rmse < state.best_rmse:
            state.best_rmse, state.best = rmse, copy.deepcopy(average.mean)
        learning_rate = self.recipe.learning_rate_at(state.minibatch - 1)
        self.log.write(Entry(state.minibatch, loss, rmse, learning_rate, rate))
        save_checkpoint(self.folder / "checkpoint.pt", state, self.recipe)

    def _write_weights(self, state: Checkpoint) -> Path:
        described = {**self.recipe.describe(), "data": self.data.described}
        card = WeightsCard(
            "lightnet", "ward", WardVariant.WARD_1992, self.both_statistics, described
        )
        path = self.folder / "lightnet.safetensors"
        save_weights(path, state.best, card, eight_bit=False)
        return path


def normalised_rmse(module: LightNet, looks: Shadings, statistics: ParameterStatistics) -> float:
    """Root mean square of the z-scored errors over looks and parameters."""
    squares = [
        (statistics.normalise(found) - statistics.normalise(truth)) ** 2
        for found, _, truth in predicted(module, looks, statistics)
    ]
    return float(np.sqrt(np.concatenate(squares).mean()))


def predicted(
    module: LightNet, looks: Shadings, statistics: ParameterStatistics
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]]:
    """Estimates, standard deviations and truths, (B, 5) Ward parameters each, batch by batch."""
    module.eval()
    for start in range(0, len(looks), MEASURED_AT_ONCE):
        rows = np.arange(start, min(start + MEASURED_AT_ONCE, len(looks)))
        with torch.inference_mode():
            means, log_variances = module(**whole_looks(looks, rows))
        deviations = np.exp(0.5 * log_variances.numpy().astype(np.float64)) * statistics.stddev
        found = statistics.restore(means.numpy().astype(np.float64))
        yield found, deviations, looks.ward[rows].astype(np.float64)
    module.train()
