# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Minibatches of scenes on the training device, each drawn from its own seed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import torch

from reflest_core.brdf.parameters import RHO_D, RHO_S
from reflest_core.models.grouplet.grouplets import BRANCHES
from reflest_core.models.registry import Inputs
from reflest_core.training.ahead import made_ahead
from reflest_core.training.recipe import Recipe
from reflest_core.training.surface.batched_grouplets import batched_grouplets
from reflest_core.training.surface.batched_hemispheres import batched_hemispheres
from reflest_core.training.surface.drawn_scenes import DrawnScenes, SceneDrawer


@dataclass(frozen=True)
class Batch:
    """``inputs`` of the network, batched; ``ward`` (B, 5) float32 truth; F and B (B, W, 3)."""

    inputs: Inputs
    ward: torch.Tensor
    foreground: torch.Tensor
    background: torch.Tensor


def draw_batch(drawer: SceneDrawer, recipe: Recipe, minibatch: int, part: int = 0) -> Batch:
    """Part ``part`` of minibatch number ``minibatch``; the same numbers give the same batch."""
    seed = np.random.SeedSequence([recipe.seed, minibatch, part]).generate_state(1)[0]
    generator = torch.Generator(drawer.device).manual_seed(int(seed))
    drawn = drawer.draw(recipe.batch_size, recipe.voxels, generator)
    ward = drawer.packed.ward[drawn.scenes]
    return Batch(
        _inputs(drawer, drawn, recipe, generator),
        torch.cat([drawn.swap(ward[:, RHO_D]), ward[:, RHO_S:]], dim=1),
        drawn.swap(drawer.view_means(drawer.packed.foreground, drawn.scenes)),
        drawn.swap(drawer.view_means(drawer.packed.background, drawn.scenes)),
    )


def joined(parts: Sequence[Batch]) -> Batch:
    """One batch of all the scenes of ``parts``."""
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
    """The given ``parts`` of the minibatches from number ``first`` to the recipe's last."""

    def draw(minibatch: int) -> Batch:
        return joined([draw_batch(drawer, recipe, minibatch, part) for part in parts])

    return made_ahead(draw, range(first, recipe.minibatches), drawer.device)


def _inputs(
    drawer: SceneDrawer, drawn: DrawnScenes, recipe: Recipe, generator: torch.Generator
) -> Inputs:
    scenes, voxels = drawn.voxels.shape
    if recipe.network == "hemicnn":
        turn = recipe.augmentation.azimuth
        azimuths = turn * (2 * torch.rand(scenes, generator=generator, device=drawer.device) - 1)
        return (batched_hemispheres(drawer.packed, drawn, azimuths),)
    shape = (scenes, voxels, recipe.nodes_per_voxel, BRANCHES)
    uniform = torch.rand(shape, generator=generator, device=drawer.device)
    return batched_grouplets(drawer.packed, drawn, uniform)
