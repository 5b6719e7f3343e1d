# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Voxel choice for a whole minibatch at once: what ``surface/voxel_choice.py`` does for one."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.voxel_choice import MIN_OBSERVATIONS

Tensor = torch.Tensor


def spread_voxels(positions: Tensor, normals: Tensor, observations: Tensor, count: int) -> Tensor:
    """Choose voxels that represent each surface: k-centres, most often observed (Gonzalez 1985).

    Args:
        positions: (B, C, 3) of candidates.
        normals: (B, C, 3).
        observations: (B, C), 0 for a voxel that must not be chosen.
        count: Voxels to choose; where there are too few candidates, some are chosen twice.

    Returns:
        (B, count) indices of candidates.
    """
    eligible = _eligible(observations, count)
    points = _cluster_space(positions.double(), normals.double(), eligible)
    clusters = _k_centre_clusters(points, eligible, count)
    candidates = observations.shape[1]
    order = torch.arange(candidates - 1, -1, -1, device=observations.device)
    key = torch.where(eligible, observations * candidates + order, -1)
    best = torch.full((len(key), count), -1, dtype=key.dtype, device=key.device)
    best = best.scatter_reduce(1, clusters, key, "amax")
    return _repeat_first(candidates - 1 - best % candidates, best >= 0)


def random_voxels(priority: Tensor, observations: Tensor, count: int) -> Tensor:
    """Choose random voxels, the smallest priority first.

    Args:
        priority: (B, C) random numbers.
        observations: (B, C), 0 for a voxel that must not be chosen.
        count: As for :func:`spread_voxels`.

    Returns:
        (B, count) indices of candidates.
    """
    eligible = _eligible(observations, count)
    first = priority.masked_fill(~eligible, torch.inf).argsort(dim=1)[:, :count]
    return _repeat_first(first, eligible.gather(1, first), count)


def _eligible(observations: Tensor, count: int) -> Tensor:
    often = observations >= MIN_OBSERVATIONS
    return torch.where(often.sum(dim=1, keepdim=True) < count, observations > 0, often)


def _cluster_space(positions: Tensor, normals: Tensor, eligible: Tensor) -> Tensor:
    """(B, C, 6): position in units of the surface's RMS extent, and normal."""
    weights = eligible[..., None].double()
    total = weights.sum(dim=1, keepdim=True).clamp(min=1)
    centred = positions - (positions * weights).sum(dim=1, keepdim=True) / total
    squared = (centred**2).sum(dim=2, keepdim=True)
    radius = ((squared * weights).sum(dim=1, keepdim=True) / total).sqrt().clamp(min=1e-9)
    return torch.cat([centred / radius, normals], dim=2)


def _k_centre_clusters(points: Tensor, eligible: Tensor, count: int) -> Tensor:
    """Cluster (B, C) of each point."""
    if points.device.type == "cpu":
        return torch.from_numpy(_one_by_one(points.numpy(), eligible.numpy(), count))
    return _in_step(points, eligible, count)


def _in_step(points: Tensor, eligible: Tensor, count: int) -> Tensor:
    clusters = torch.zeros(points.shape[:2], dtype=torch.int64, device=points.device)
    squared = torch.full_like(points[..., 0], torch.inf)
    norms = (points**2).sum(dim=2).masked_fill(~eligible, -1.0)
    centre = norms.argmax(dim=1)
    for cluster in range(count):
        at_centre = points.gather(1, centre[:, None, None].expand(-1, 1, points.shape[2]))
        distance = ((points - at_centre) ** 2).sum(dim=2)
        closer = distance < squared
        squared = torch.where(closer, distance, squared)
        clusters = torch.where(closer, cluster, clusters)
        centre = squared.masked_fill(~eligible, -1.0).argmax(dim=1)
    return clusters


@compiled
def _one_by_one(
    points: NDArray[np.float64], eligible: NDArray[np.bool_], count: int
) -> NDArray[np.int64]:
    clusters = np.zeros(points.shape[:2], np.int64)
    squared = np.empty(points.shape[1])
    for scene in range(points.shape[0]):
        squared[:] = np.inf
        centre, farthest = 0, -1.0
        for p in range(points.shape[1]):
            norm = (points[scene, p] ** 2).sum()
            if eligible[scene, p] and norm > farthest:
                centre, farthest = p, norm
        for cluster in range(count):
            c0, c1, c2, c3, c4, c5 = points[scene, centre]
            farthest = -1.0
            for p in range(points.shape[1]):
                x = points[scene, p]
                distance = (
                    (x[0] - c0) ** 2
                    + (x[1] - c1) ** 2
                    + (x[2] - c2) ** 2
                    + (x[3] - c3) ** 2
                    + (x[4] - c4) ** 2
                    + (x[5] - c5) ** 2
                )
                if distance < squared[p]:
                    squared[p] = distance
                    clusters[scene, p] = cluster
                if eligible[scene, p] and squared[p] > farthest:
                    centre, farthest = p, squared[p]
    return clusters


def _repeat_first(chosen: Tensor, is_valid: Tensor, count: int | None = None) -> Tensor:
    """The valid ones of ``chosen`` (B, K), as often as it takes to fill ``count`` places."""
    places = count or chosen.shape[1]
    front = (~is_valid).to(torch.uint8).argsort(dim=1, stable=True)
    valid = is_valid.sum(dim=1, keepdim=True).clamp(min=1)
    return chosen.gather(1, front.gather(1, torch.arange(places, device=chosen.device) % valid))
