"""Minibatches, made ahead of the optimiser in a second thread; each from its own seed."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import torch

from reflest_core.features.voxel_choice import choose_voxels
from reflest_core.models.network_kind import NETWORKS, FeatureDraw, Inputs
from reflest_core.training.recipe import Recipe
from reflest_core.training.sample import Sample

AHEAD = 4


@dataclass(frozen=True)
class Batch:
    """``inputs`` of the network, batched; ``ward`` (B, 5) float32 truth; F and B (B, W, 3)."""

    inputs: Inputs
    ward: torch.Tensor
    foreground: torch.Tensor
    background: torch.Tensor


def draw_batch(samples: list[Sample], recipe: Recipe, minibatch: int) -> Batch:
    """Minibatch number ``minibatch``; the same number gives the same batch."""
    rng = np.random.default_rng([recipe.seed, minibatch])
    chosen = rng.integers(0, len(samples), recipe.batch_size)
    return stack([_draw_sample(samples[index], recipe, rng) for index in chosen], recipe, rng)


def stack(samples: list[Sample], recipe: Recipe, rng: np.random.Generator) -> Batch:
    """Features of every sample at ``recipe.voxels`` voxels, stacked."""
    kind = NETWORKS[recipe.network]
    turn = recipe.augmentation.azimuth
    features = []
    for sample in samples:
        # Where fewer voxels were seen, some stand in twice.
        voxels = np.resize(choose_voxels(sample.surface, recipe.voxels), recipe.voxels)
        draw = FeatureDraw(
            int(rng.integers(2**31)), float(rng.uniform(-turn, turn)), recipe.nodes_per_voxel
        )
        features.append(kind.features(sample.surface, voxels, draw))
    inputs = tuple(torch.stack(column) for column in zip(*features, strict=True))
    ward = torch.from_numpy(np.stack([sample.ward for sample in samples])).float()
    foreground = np.stack([sample.surface.view_foreground for sample in samples])
    background = np.stack([sample.surface.view_background for sample in samples])
    return Batch(inputs, ward, torch.from_numpy(foreground), torch.from_numpy(background))


def batches(samples: list[Sample], recipe: Recipe, first: int) -> Iterator[Batch]:
    """Minibatches from number ``first`` to the recipe's last, prepared ahead."""
    with ThreadPoolExecutor(1) as pool:
        waiting: list[Future[Batch]] = []
        upcoming = iter(range(first, recipe.minibatches))
        for _ in range(first, recipe.minibatches):
            while len(waiting) < AHEAD and (minibatch := next(upcoming, None)) is not None:
                waiting.append(pool.submit(draw_batch, samples, recipe, minibatch))
            yield waiting.pop(0).result()


def _draw_sample(sample: Sample, recipe: Recipe, rng: np.random.Generator) -> Sample:
    """A varied copy with at least one observed voxel; the scene itself if chance left none."""
    varied = recipe.augmentation.apply(sample, rng)
    return varied if len(varied.surface.colours) else sample
