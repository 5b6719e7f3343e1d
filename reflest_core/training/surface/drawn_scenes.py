# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Draws minibatches of scenes, each seen from some of its views at some of its voxels."""

from __future__ import annotations

import math

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.models.minibatch import DrawnScenes, PackedScenes
from reflest_core.models.recipe import Augmentation
from reflest_core.training.surface.spread_voxels import random_voxels, spread_voxels

Tensor = torch.Tensor


class SceneDrawer:
    """Draws minibatches of one :class:`PackedScenes` from one generator, on its device."""

    def __init__(self, packed: PackedScenes, augmentation: Augmentation) -> None:
        """Prepare to draw from ``packed``, varied by ``augmentation``.

        Args:
            packed: The scenes to draw from.
            augmentation: How they are varied.
        """
        self.packed, self.augmentation = packed, augmentation
        self.most_voxels, self.most_views = packed.most_voxels, packed.most_views
        self.most_observations = packed.most_observations
        self.device = packed.ward.device

    def draw(self, batch_size: int, voxels: int, generator: torch.Generator) -> DrawnScenes:
        """Draw scenes; equally seeded generators draw the same.

        Voxels are chosen as :func:`~reflest_core.surface.voxel_choice.choose_voxels` does among
        ``augmentation.candidates``, or at random where ``augmentation.spread`` is off.

        Args:
            batch_size: B, scenes; one may be drawn twice.
            voxels: N, voxels of each.
            generator: Of random numbers, on the scenes' device.
        """
        packed = self.packed
        scenes = torch.randint(packed.count, (batch_size,), generator=generator, device=self.device)
        kept = self._kept_views(scenes, generator)
        candidates, priority = self._candidates(scenes, generator)
        counts = self._counts(scenes, candidates, kept).masked_fill(priority.isinf(), 0)
        if self.augmentation.spread:
            positions, normals = packed.positions[candidates], packed.normals[candidates]
            chosen = spread_voxels(positions, normals, counts, voxels)
        else:
            chosen = random_voxels(priority, counts, voxels)
        chosen_voxels = candidates.gather(1, chosen)
        rows, views, seen = self._observations(scenes, chosen_voxels, kept)
        turn = 2 * math.pi * self._uniform(generator, batch_size)
        order = self._uniform(generator, batch_size, 3).argsort(dim=1)
        if not self.augmentation.channel_swap:
            order = torch.arange(3, device=self.device).expand(batch_size, 3)
        return DrawnScenes(
            scenes,
            chosen_voxels,
            rows,
            views,
            seen,
            about_vertical(turn),
            order,
        )

    def view_means(self, means: Tensor, scenes: Tensor) -> Tensor:
        """Gather F or B of all views of some scenes: (B, W, 3), NaN in the places of no view.

        Args:
            means: F or B of all packed views.
            scenes: (B,) indices of scenes.
        """
        first = self.packed.first_view[scenes][:, None]
        count = self.packed.first_view[scenes + 1][:, None] - first
        place = torch.arange(self.most_views, device=self.device)
        values = means[first + torch.minimum(place, count - 1)]
        return values.masked_fill((place >= count)[..., None], torch.nan)

    def _uniform(self, generator: torch.Generator, *shape: int) -> Tensor:
        return torch.rand(shape, generator=generator, device=self.device)

    def _kept_views(self, scenes: Tensor, generator: torch.Generator) -> Tensor:
        """(B, W) bool: a random subset of each scene's views, its size uniform within limits."""
        counts = torch.diff(self.packed.first_view)[scenes][:, None]
        keys = self._uniform(generator, len(scenes), self.most_views)
        absent = torch.arange(self.most_views, device=self.device) >= counts
        rank = keys.masked_fill(absent, torch.inf).argsort(dim=1).argsort(dim=1)
        low, high = (counts.clamp(max=limit) for limit in self.augmentation.views)
        share = self._uniform(generator, len(scenes), 1)
        size = (low + (share * (high - low + 1)).long()).clamp(max=high)
        return (rank < size) & ~absent

    def _candidates(self, scenes: Tensor, generator: torch.Generator) -> tuple[Tensor, Tensor]:
        """Random voxels (B, C) of each scene and their rank keys, infinite where there is none."""
        first = self.packed.first_voxel[scenes][:, None]
        counts = self.packed.first_voxel[scenes + 1][:, None] - first
        keys = self._uniform(generator, len(scenes), self.most_voxels)
        absent = torch.arange(self.most_voxels, device=self.device) >= counts
        size = min(self.augmentation.candidates, self.most_voxels)
        priority, index = keys.masked_fill(absent, torch.inf).topk(size, dim=1, largest=False)
        return first + torch.minimum(index, counts - 1), priority

    def _counts(self, scenes: Tensor, voxels: Tensor, kept: Tensor) -> Tensor:
        """(B, C) observations of ``voxels`` from kept views."""
        if self.device.type != "cpu":
            return self._observations(scenes, voxels, kept)[2].sum(dim=2)
        offsets, view_of = self.packed.offsets.numpy(), self.packed.view_of.numpy()
        return torch.from_numpy(_kept_counts(offsets, view_of, voxels.numpy(), kept.numpy()))

    def _observations(
        self, scenes: Tensor, voxels: Tensor, kept: Tensor
    ) -> tuple[Tensor, Tensor, Tensor]:
        """Rows, packed views and whether seen, (B, C, M) each."""
        packed = self.packed
        place = torch.arange(self.most_observations, device=self.device)
        first, last = packed.offsets[voxels][..., None], packed.offsets[voxels + 1][..., None]
        rows = (first + place).clamp(max=len(packed.view_of) - 1)
        views = packed.view_of[rows].long()
        views = torch.where(first + place < last, views, 0)
        is_kept = kept.gather(1, views.flatten(1)).view(views.shape)
        seen = is_kept & (first + place < last)
        return rows, views + packed.first_view[scenes][:, None, None], seen


@compiled
def _kept_counts(
    offsets: NDArray[np.int64],
    view_of: NDArray[np.int16],
    voxels: NDArray[np.int64],
    kept: NDArray[np.bool_],
) -> NDArray[np.int64]:
    counts = np.zeros(voxels.shape, np.int64)
    for scene in range(voxels.shape[0]):
        for place in range(voxels.shape[1]):
            voxel = voxels[scene, place]
            for row in range(offsets[voxel], offsets[voxel + 1]):
                counts[scene, place] += kept[scene, view_of[row]]
    return counts


def about_vertical(angles: Tensor) -> Tensor:
    """Make rotations (B, 3, 3) by ``angles`` (B,) radians about +z.

    Args:
        angles: (B,) radians.
    """
    cosine, sine, zero, one = angles.cos(), angles.sin(), angles * 0, angles * 0 + 1
    rows = [cosine, -sine, zero, sine, cosine, zero, zero, zero, one]
    return torch.stack(rows, dim=1).view(-1, 3, 3)
