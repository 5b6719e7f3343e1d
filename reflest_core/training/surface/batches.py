# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Minibatches of scenes on the training device, each drawn from its own seed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import torch

from reflest_core.brdf.parameters import RHO_D, RHO_S
from reflest_core.models.recipe import Recipe
from reflest_core.models.registry import network_named
from reflest_core.training.surface.drawn_scenes import SceneDrawer
from reflest_core.training.task import prepared_ahead


@dataclass(frozen=True)
class Batch:
    """B scenes.

    Attributes:
        inputs: The network's arguments.
        ward: (B, 5) float32, the truth.
        foreground: (B, W, 3), mean colour F of each view, NaN where unknown.
        background: (B, W, 3), mean colour B of each view, NaN where unknown.
    """

    inputs: tuple[torch.Tensor, ...]
    ward: torch.Tensor
    foreground: torch.Tensor
    background: torch.Tensor


def draw_batch(drawer: SceneDrawer, recipe: Recipe, minibatch: int, part: int = 0) -> Batch:
    """Draw one part of a minibatch; the same numbers give the same batch.

    Args:
        drawer: Of the training's scenes.
        recipe: The training's.
        minibatch: Its number.
        part: Which part of it.
    """
    seed = np.random.SeedSequence([recipe.seed, minibatch, part]).generate_state(1)[0]
    generator = torch.Generator(drawer.device).manual_seed(int(seed))
    drawn = drawer.draw(recipe.batch_size, recipe.voxels, generator)
    ward = drawer.packed.ward[drawn.scenes]
    network = network_named(recipe.network)
    return Batch(
        network.batched_features(drawer.packed, drawn, recipe, generator),
        torch.cat([drawn.swap(ward[:, RHO_D]), ward[:, RHO_S:]], dim=1),
        drawn.swap(drawer.view_means(drawer.packed.foreground, drawn.scenes)),
        drawn.swap(drawer.view_means(drawer.packed.background, drawn.scenes)),
    )


def joined(parts: Sequence[Batch]) -> Batch:
    """Join parts into one batch.

    Args:
        parts: Of one minibatch.
    """
    if len(parts) == 1:
        return parts[0]
    return Batch(
        tuple(torch.cat(column) for column in zip(*(part.inputs for part in parts), strict=True)),
        torch.cat([part.ward for part in parts]),
        torch.cat([part.foreground for part in parts]),
        torch.cat([part.background for part in parts]),
    )


def batches(
    drawer: SceneDrawer, recipe: Recipe, first: int, parts: Sequence[int] = (0,)
) -> Iterator[Batch]:
    """Draw parts of the minibatches from number ``first`` to the recipe's last.

    Args:
        drawer: Of the training's scenes.
        recipe: The training's.
        first: Number of the first minibatch.
        parts: Which parts of each, joined.
    """

    def draw(minibatch: int) -> Batch:
        return joined([draw_batch(drawer, recipe, minibatch, part) for part in parts])

    return prepared_ahead(draw, range(first, recipe.minibatches), drawer.device)
