# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Minibatches of looks for ``lightnet``: fewer voxels and observations, turned, colours swapped."""

from __future__ import annotations

import math

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.training.light.shading_shards import Shadings

Look = dict[str, torch.Tensor]
"""The arguments of ``LightNet.forward``, batched."""

OBSERVED = ("is_seen", "apparent", "clipped", "cosine", "lobe", "lobe_seen", "lobe_clipped")
"""Arrays (B, V, O, ...)."""
OF_VOXELS = ("normals", "diffuse_light", "diffuse_seen", "diffuse_clipped", "voxel_fit")
"""Arrays (B, V, ...)."""
CHANNEL_AXIS = {
    "apparent": -1, "clipped": -1, "lobe": -1, "diffuse_light": -1, "voxel_fit": 2, "scene_fit": 1
}  # fmt: skip


def whole_looks(shadings: Shadings, rows: NDArray[np.int64]) -> Look:
    """The looks as they are, for measuring."""
    arrays = {name: torch.from_numpy(array[rows]) for name, array in shadings.arrays.items()}
    return {name: t if t.dtype == torch.bool else t.float() for name, t in arrays.items()}


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
    look = whole_looks(shadings, rows)
    truth = torch.from_numpy(shadings.ward[rows])
    _thin(look, voxels, observations, generator)
    order = torch.randperm(3, generator=generator)
    for name, axis in CHANNEL_AXIS.items():
        look[name] = look[name].index_select(axis, order)
    look["zones"] = torch.cat([look["zones"][..., order], look["zones"][..., 3:]], dim=-1)
    look["normals"] = _turned(look["normals"], generator)
    return look, torch.cat([truth[:, order], truth[:, 3:]], dim=1)


def _thin(look: Look, voxels: int, observations: int, generator: torch.Generator) -> None:
    """Keep a random choice; what was never seen is only chosen where there is too little else."""
    seen = look["is_seen"]
    size = len(seen)
    unseen = (~seen.any(dim=2)).float()
    chosen = (torch.rand(seen.shape[:2], generator=generator) + 2 * unseen).argsort(1)[:, :voxels]
    batch = torch.arange(size)[:, None]
    for name in (*OBSERVED, *OF_VOXELS):
        look[name] = look[name][batch, chosen]
    seen = look["is_seen"]
    order = torch.rand(seen.shape, generator=generator) + 2 * (~seen).float()
    kept = order.argsort(2)[:, :, :observations]
    batch, voxel = torch.arange(size)[:, None, None], torch.arange(seen.shape[1])[None, :, None]
    for name in OBSERVED:
        look[name] = look[name][batch, voxel, kept]


def _turned(normals: torch.Tensor, generator: torch.Generator) -> torch.Tensor:
    angle = 2 * math.pi * torch.rand(len(normals), 1, generator=generator)
    mirror = torch.where(torch.rand(len(normals), 1, generator=generator) < 0.5, -1.0, 1.0)
    x, y = normals[..., 0], normals[..., 1]
    turned_x = x * angle.cos() - y * angle.sin()
    turned_y = (x * angle.sin() + y * angle.cos()) * mirror
    return torch.stack([turned_x, turned_y, normals[..., 2]], dim=-1)
