# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Grouplets of a whole minibatch; ``models/grouplet/grouplets.py`` draws those of one surface."""

from __future__ import annotations

import torch

from reflest_core.models.grouplet.grouplets import BRANCHES
from reflest_core.models.minibatch import DrawnScenes, PackedScenes

Tensor = torch.Tensor


def batched_grouplets(
    packed: PackedScenes, drawn: DrawnScenes, uniform: Tensor
) -> tuple[Tensor, Tensor]:
    """Draw grouplets of a whole minibatch.

    The same numbers choose the same observations as in
    :func:`~reflest_core.models.grouplet.grouplets.draw_grouplets`, but here nodes draw from all of
    a voxel's observations, not from 20 that they share. A voxel without observations enters as 0.

    Args:
        packed: All training scenes.
        drawn: The scenes of the minibatch.
        uniform: (B, N, K, 5) float in [0, 1), which chooses the observations of K nodes a voxel.

    Returns:
        Branches (B, N K, 5, 12) and normals (B, N K, 3) of K nodes a voxel.
    """
    places = choose_observations(drawn.seen, uniform)
    nodes = uniform.shape[2]
    rows, views = (_at(values, places).flatten(1, 2) for values in (drawn.rows, drawn.views))
    voxels = drawn.voxels.repeat_interleave(nodes, dim=1)
    normals = packed.normals[voxels]
    towards = packed.view_centres[views] - packed.positions[voxels][:, :, None]
    directions = torch.nn.functional.normalize(towards, dim=-1)
    cosines = (directions * normals[:, :, None]).sum(dim=-1)
    order = (-cosines).argsort(dim=-1, stable=True)
    colours = drawn.swap(packed.colours[rows].float() / 255)
    view_means = (
        drawn.swap(packed.foreground[views].nan_to_num() / 255),
        drawn.swap(packed.background[views].nan_to_num() / 255),
    )
    branches = torch.cat([colours, drawn.turn(directions), *view_means], dim=-1)
    is_seen = drawn.seen.any(dim=2).repeat_interleave(nodes, dim=1)
    branches = branches.gather(2, order[..., None].expand_as(branches))
    return branches * is_seen[..., None, None], drawn.turn(normals)


def choose_observations(seen: Tensor, uniform: Tensor) -> Tensor:
    """Choose observations, without replacement where a voxel has five.

    Args:
        seen: (B, N, M) bool, the places that hold an observation.
        uniform: (B, N, K, 5) in [0, 1).

    Returns:
        (B, N, K, 5), places of seen observations.
    """
    count = seen.sum(dim=2)[:, :, None]
    taken = torch.empty(uniform.shape, dtype=torch.int64, device=seen.device)
    for k in range(BRANCHES):
        index = (uniform[..., k].double() * (count - k).clamp(min=1)).long()
        # The index-th of those left: step over the taken ones in rising order.
        for earlier in taken[..., :k].sort(dim=-1).values.unbind(dim=-1):
            index = index + (index >= earlier)
        with_replacement = (uniform[..., k].double() * count).long()
        taken[..., k] = torch.where(count < BRANCHES, with_replacement, index)
    in_order = (~seen).to(torch.uint8).argsort(dim=2, stable=True)
    return in_order.gather(2, taken.flatten(2)).view(uniform.shape)


def _at(values: Tensor, places: Tensor) -> Tensor:
    """``values`` (B, N, M) at ``places`` (B, N, K, 5)."""
    return values.gather(2, places.flatten(2)).view(places.shape)
