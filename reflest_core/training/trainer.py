"""The training loop: minibatches in, weight file out; resumable, logged, atomic."""

from __future__ import annotations

import copy
import csv
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.brdf.parameters import WardVariant
from reflest_core.features.voxel_choice import choose_voxels
from reflest_core.models.network_kind import NETWORKS, FeatureDraw
from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.models.weights import WeightsCard, save_weights
from reflest_core.training.batches import Batch, batches
from reflest_core.training.checkpoint import Checkpoint, load_checkpoint, save_checkpoint
from reflest_core.training.metrics import normalised_rmse
from reflest_core.training.objective import Objective
from reflest_core.training.recipe import Recipe
from reflest_core.training.sample import Sample

VALIDATE_EVERY = 1000
EIGHT_BIT = {"hemicnn": False, "grouplet": True}
"""Grouplet meets the paper's size only in 8 bits (SPEC, Grouplet)."""


class Trainer:
    """Trains one network by one recipe in one folder."""

    def __init__(
        self,
        recipe: Recipe,
        training: list[Sample],
        validation: list[Sample],
        folder: Path,
        data: dict[str, Any],
    ) -> None:
        """``data`` describes the data set in the weight file's card."""
        torch.manual_seed(recipe.seed)
        folder.mkdir(parents=True, exist_ok=True)
        self.recipe, self.training, self.folder, self.data = recipe, training, folder, data
        self.truths = np.stack([sample.parameters(recipe.parameters) for sample in validation])
        self.both_statistics = {kind: _statistics(training, kind) for kind in ("ward", "labcd")}
        self.statistics = self.both_statistics[recipe.parameters]
        self.objective = Objective(recipe, self.statistics)
        self.module = NETWORKS[recipe.network].make()
        self.optimiser = recipe.make_optimiser(self.module)
        self.validation_inputs = [self._validation_inputs(sample) for sample in validation]

    def run(self) -> Path:
        """Train on from the folder's checkpoint to the end; return the weight file.

        The same weights unquantised stand beside it as ``<network>-float32.safetensors``.
        """
        state = self._resume()
        running = 0.0
        progress = tqdm(total=self.recipe.minibatches, initial=state.minibatch, unit="batch")
        for batch in batches(self.training, self.recipe, state.minibatch):
            running += self._step(batch, state.minibatch)
            state.minibatch += 1
            progress.update()
            last = state.minibatch == self.recipe.minibatches
            if last or state.minibatch % VALIDATE_EVERY == 0:
                rmse = self._validate(state)
                progress.set_postfix(validation=f"{rmse:.3f}", best=f"{state.best_rmse:.3f}")
                self._log(state.minibatch, running / VALIDATE_EVERY, rmse)
                running = 0.0
                save_checkpoint(self.folder / "checkpoint.pt", state, self.recipe)
        progress.close()
        return self._write_weights(state)

    def _resume(self) -> Checkpoint:
        found = load_checkpoint(self.folder / "checkpoint.pt", self.recipe)
        if found is None:
            weights = self.module.state_dict()
            return Checkpoint(0, weights, self.optimiser.state_dict(), weights, float("inf"))
        self.module.load_state_dict(found.module)
        self.optimiser.load_state_dict(found.optimiser)
        return found

    def _step(self, batch: Batch, minibatch: int) -> float:
        for group in self.optimiser.param_groups:
            group["lr"] = self.recipe.learning_rate_at(minibatch)
        self.optimiser.zero_grad()
        loss = self.objective(self.module(*batch.inputs), batch)
        loss.backward()  # type: ignore[no-untyped-call]
        self.optimiser.step()
        return loss.item()

    def _validation_inputs(self, sample: Sample) -> tuple[torch.Tensor, ...]:
        voxels = choose_voxels(sample.surface, self.recipe.voxels)
        features = NETWORKS[self.recipe.network].features
        return features(sample.surface, voxels, FeatureDraw(seed=0))

    def _validate(self, state: Checkpoint) -> float:
        """Normalised RMSE on validation; keeps the best weights in ``state``."""
        rmse = normalised_rmse(self._predict(), self.truths, self.statistics).overall
        state.module = self.module.state_dict()
        state.optimiser = self.optimiser.state_dict()
        if rmse < state.best_rmse:
            state.best_rmse, state.best = rmse, copy.deepcopy(state.module)
        return rmse

    def _predict(self) -> NDArray[np.float64]:
        with torch.inference_mode():
            scores = [
                self.module(*(tensor[None] for tensor in inputs))[0]
                for inputs in self.validation_inputs
            ]
        return self.statistics.restore(torch.stack(scores).double().numpy())

    def _log(self, minibatch: int, loss: float, rmse: float) -> None:
        path = self.folder / "log.csv"
        is_new = not path.exists()
        with path.open("a", newline="") as file:
            writer = csv.writer(file)
            if is_new:
                writer.writerow(["minibatch", "training_loss", "validation_rmse"])
            writer.writerow([minibatch, f"{loss:.5f}", f"{rmse:.5f}"])

    def _write_weights(self, state: Checkpoint) -> Path:
        recipe = {**self.recipe.describe(), "data": self.data}
        card = WeightsCard(
            self.recipe.network,
            self.recipe.parameters,
            WardVariant.WARD_1992,
            self.both_statistics,
            recipe,
        )
        path = self.folder / f"{self.recipe.network}.safetensors"
        save_weights(path, state.best, card, EIGHT_BIT[self.recipe.network])
        exact = self.folder / f"{self.recipe.network}-float32.safetensors"
        save_weights(exact, state.best, card, eight_bit=False)
        return path


def _statistics(samples: list[Sample], kind: str) -> ParameterStatistics:
    return ParameterStatistics.of(np.stack([sample.parameters(kind) for sample in samples]))
