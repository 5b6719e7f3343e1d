# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Minibatches of simulated scans: fewer voxels and observations, turned, colours swapped."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.models.recipe import Recipe
from reflest_core.training.light.ablation import Features, hide
from reflest_core.training.light.scan_file import AXES
from reflest_core.training.light.stored_scans import StoredScans
from reflest_core.training.task import prepared_ahead


@dataclass(frozen=True)
class LightBatch:
    """B scans.

    Attributes:
        features: The arguments of ``LightNet.forward``.
        ward: (B, 5) float32, the truth.
    """

    features: Features
    ward: torch.Tensor


def light_batches(
    scans: StoredScans,
    recipe: Recipe,
    first: int,
    parts: Sequence[int],
    device: torch.device,
) -> Iterator[LightBatch]:
    """Draw parts of the minibatches from number ``first`` to the recipe's last.

    Args:
        scans: To draw from.
        recipe: The training's.
        first: Number of the first minibatch.
        parts: Which parts of each, joined.
        device: Where the network is.
    """

    def draw(minibatch: int) -> LightBatch:
        drawn = [draw_scans(scans, recipe, minibatch, part) for part in parts]
        features = {
            name: torch.cat([one.features[name] for one in drawn]).to(device) for name in AXES
        }
        return LightBatch(features, torch.cat([one.ward for one in drawn]).to(device))

    return prepared_ahead(draw, range(first, recipe.minibatches), device)


def draw_scans(scans: StoredScans, recipe: Recipe, minibatch: int, part: int) -> LightBatch:
    """Draw one part of a minibatch; the same numbers give the same scans.

    Args:
        scans: To draw from.
        recipe: The training's.
        minibatch: Its number.
        part: Which part of it.
    """
    rng = np.random.default_rng([recipe.seed, minibatch, part])
    rows = rng.integers(len(scans), size=recipe.batch_size)
    generator = torch.Generator().manual_seed(int(rng.integers(2**31)))
    features, ward = varied_scans(scans, rows, recipe.voxels, recipe.observations, generator)
    hide(features, recipe.without)
    return LightBatch(features, ward)


def whole_scans(
    scans: StoredScans, rows: NDArray[np.int64], without: tuple[str, ...] = ()
) -> Features:
    """Return scans as they are, for measuring.

    Args:
        scans: To take from.
        rows: Which.
        without: Parts that are hidden.
    """
    features = {name: _as_input(torch.from_numpy(scans.arrays[name][rows])) for name in AXES}
    hide(features, without)
    return features


def varied_scans(
    scans: StoredScans,
    rows: NDArray[np.int64],
    voxels: int,
    observations: int,
    generator: torch.Generator,
) -> tuple[Features, torch.Tensor]:
    """Vary scans such that their truth stays true.

    The world is turned and mirrored about the vertical; colour channels are permuted in light and
    material alike.

    Args:
        scans: To take from.
        rows: (B,), which.
        voxels: At most so many random voxels are kept.
        observations: At most so many random observations of each voxel are kept.
        generator: Of random numbers.

    Returns:
        The features, and the truth (B, 5) that goes with them.
    """
    features = _thinned(scans, torch.from_numpy(rows), voxels, observations, generator)
    order = torch.randperm(3, generator=generator)
    for name, axes in AXES.items():
        if "C" in axes:
            features[name] = features[name].index_select(1 + axes.index("C"), order)
        elif "R" in axes:
            colours, shares = features[name][..., order], features[name][..., 3:]
            features[name] = torch.cat([colours, shares], dim=-1)
    angle = 2 * math.pi * torch.rand(len(rows), 1, generator=generator)
    mirror = torch.where(torch.rand(len(rows), 1, generator=generator) < 0.5, -1.0, 1.0)
    for name in (name for name, axes in AXES.items() if "D" in axes):
        features[name] = _turned(features[name], angle, mirror)
    truth = torch.from_numpy(scans.ward[rows])
    return features, torch.cat([truth[:, order], truth[:, 3:]], dim=1)


def _thinned(
    scans: StoredScans,
    rows: torch.Tensor,
    voxels: int,
    observations: int,
    generator: torch.Generator,
) -> Features:
    """A random choice; what was never seen is only chosen where there is too little else."""
    stored = {name: torch.from_numpy(scans.arrays[name]) for name in AXES}
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
    features = {}
    for name, axes in AXES.items():
        common = "VO" if axes.startswith("VO") else "V" if axes.startswith("V") else ""
        features[name] = _as_input(stored[name][at[common]])
    return features


def _as_input(values: torch.Tensor) -> torch.Tensor:
    return values if values.dtype == torch.bool else values.float()


def _turned(directions: torch.Tensor, angle: torch.Tensor, mirror: torch.Tensor) -> torch.Tensor:
    """(B, V, 3) turned by ``angle`` (B, 1) about the vertical, y times ``mirror`` (B, 1)."""
    x, y = directions[..., 0], directions[..., 1]
    turned_x = x * angle.cos() - y * angle.sin()
    turned_y = (x * angle.sin() + y * angle.cos()) * mirror
    return torch.stack([turned_x, turned_y, directions[..., 2]], dim=-1)
