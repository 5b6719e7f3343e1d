# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Minibatches of looks for ``lightnet``: fewer voxels and observations, turned, colours swapped."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.training.ahead import made_ahead
from reflest_core.training.light.ablation import Look, hide
from reflest_core.training.light.shading_axes import AXES
from reflest_core.training.light.shadings import Shadings
from reflest_core.training.recipe import Recipe


@dataclass(frozen=True)
class LightBatch:
    """``look``: the arguments of ``LightNet.forward``. ``ward``: (B, 5) float32 truth."""

    look: Look
    ward: torch.Tensor


def light_batches(
    shadings: Shadings,
    recipe: Recipe,
    first: int,
    parts: Sequence[int],
    device: torch.device,
) -> Iterator[LightBatch]:
    """The given ``parts`` of the minibatches from number ``first`` to the recipe's last."""

    def draw(minibatch: int) -> LightBatch:
        drawn = [draw_looks(shadings, recipe, minibatch, part) for part in parts]
        look = {name: torch.cat([one.look[name] for one in drawn]).to(device) for name in AXES}
        return LightBatch(look, torch.cat([one.ward for one in drawn]).to(device))

    return made_ahead(draw, range(first, recipe.minibatches), device)


def draw_looks(shadings: Shadings, recipe: Recipe, minibatch: int, part: int) -> LightBatch:
    """One part of a minibatch; the same numbers give the same looks."""
    rng = np.random.default_rng([recipe.seed, minibatch, part])
    rows = rng.integers(len(shadings), size=recipe.batch_size)
    generator = torch.Generator().manual_seed(int(rng.integers(2**31)))
    look, ward = varied_looks(shadings, rows, recipe.voxels, recipe.observations, generator)
    hide(look, recipe.without)
    return LightBatch(look, ward)


def whole_looks(shadings: Shadings, rows: NDArray[np.int64], without: tuple[str, ...] = ()) -> Look:
    """The looks as they are, for measuring, but for the parts they are to do without."""
    look = {name: _as_input(torch.from_numpy(shadings.arrays[name][rows])) for name in AXES}
    hide(look, without)
    return look


def varied_looks(
    shadings: Shadings,
    rows: NDArray[np.int64],
    voxels: int,
    observations: int,
    generator: torch.Generator,
) -> tuple[Look, torch.Tensor]:
    """The looks varied without untruth, and the truth (B, 5) that goes with them.

    At most ``voxels`` random voxels with ``observations`` random observations each; world turned
    and mirrored about the vertical; colour channels permuted in light and material alike.
    """
    look = _thinned(shadings, torch.from_numpy(rows), voxels, observations, generator)
    order = torch.randperm(3, generator=generator)
    for name, axes in AXES.items():
        if "C" in axes:
            look[name] = look[name].index_select(1 + axes.index("C"), order)
        elif "R" in axes:
            colours, shares = look[name][..., order], look[name][..., 3:]
            look[name] = torch.cat([colours, shares], dim=-1)
    angle = 2 * math.pi * torch.rand(len(rows), 1, generator=generator)
    mirror = torch.where(torch.rand(len(rows), 1, generator=generator) < 0.5, -1.0, 1.0)
    for name in (name for name, axes in AXES.items() if "D" in axes):
        look[name] = _turned(look[name], angle, mirror)
    truth = torch.from_numpy(shadings.ward[rows])
    return look, torch.cat([truth[:, order], truth[:, 3:]], dim=1)


def _thinned(
    shadings: Shadings,
    rows: torch.Tensor,
    voxels: int,
    observations: int,
    generator: torch.Generator,
) -> Look:
    """A random choice; what was never seen is only chosen where there is too little else."""
    stored = {name: torch.from_numpy(shadings.arrays[name]) for name in AXES}
    seen = stored["is_seen"][rows]
    unseen = (~seen.any(dim=2)).float()
    chosen = (torch.rand(unseen.shape, generator=generator) + 2 * unseen).argsort(1)[:, :voxels]
    seen = stored["is_seen"][rows[:, None], chosen]
    order = torch.rand(seen.shape, generator=generator) + 2 * (~seen).float()
    kept = order.argsort(2)[:, :, :observations]
    at = {
        "VO": (rows[:, None, None], chosen[:, :, None], kept),
        "V": (rows[:, None], chosen),
        "": (rows,),
    }
    look = {}
    for name, axes in AXES.items():
        common = "VO" if axes.startswith("VO") else "V" if axes.startswith("V") else ""
        look[name] = _as_input(stored[name][at[common]])
    return look


def _as_input(values: torch.Tensor) -> torch.Tensor:
    return values if values.dtype == torch.bool else values.float()


def _turned(directions: torch.Tensor, angle: torch.Tensor, mirror: torch.Tensor) -> torch.Tensor:
    """(B, V, 3) turned by ``angle`` (B, 1) about the vertical, y times ``mirror`` (B, 1)."""
    x, y = directions[..., 0], directions[..., 1]
    turned_x = x * angle.cos() - y * angle.sin()
    turned_y = (x * angle.sin() + y * angle.cos()) * mirror
    return torch.stack([turned_x, turned_y, directions[..., 2]], dim=-1)
