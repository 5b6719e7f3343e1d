# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Gloss groups: segments of one surface whose gloss agrees are one material of several colours.

A texture divides a surface into segments of few colours that recur side by side. Segments are
grouped where three things hold: they lie on one smooth surface, their posteriors of roughness
agree, and their colours are alike or alternate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.segmentation.graph import find_root, renumbered

SMOOTH = 0.35
"""Mean distance of unit normals across a border, up to which two segments are one surface."""
SHORTEST = 8
"""Pairs of voxels of the shortest border."""
DISAGREEMENT = 4.0
"""Loss of log-likelihood, by one roughness for both, up to which two posteriors agree."""
SAME_COLOUR = 10.0
"""Distance in Lab (with L halved) up to which two colours are one."""
RECURRING = 4
"""Segments of two colours together, at least one of each, from which they are a texture."""


@dataclass(frozen=True)
class Borders:
    """Where segments touch.

    Attributes:
        segments: (B, 2) int64, the two segments of each border, the smaller label first.
        lengths: (B,) int64, pairs of neighbouring voxels across it.
        bends: (B,) float64, mean distance of unit normals across it.
    """

    segments: NDArray[np.int64]
    lengths: NDArray[np.int64]
    bends: NDArray[np.float64]

    @staticmethod
    def of(
        labels: NDArray[np.int64], pairs: NDArray[np.int32], normals: NDArray[np.float32]
    ) -> Borders:
        """Measure all borders.

        Args:
            labels: (V,) segments 0, 1, ...
            pairs: (E, 2) neighbouring voxels.
            normals: (V, 3) unit.
        """
        ends = np.sort(labels[pairs], axis=1).reshape(-1, 2)
        crosses = ends[:, 0] != ends[:, 1]
        across = pairs[crosses]
        bends = np.linalg.norm(normals[across[:, 0]] - normals[across[:, 1]], axis=1)
        segments, inverse, lengths = np.unique(
            ends[crosses], axis=0, return_inverse=True, return_counts=True
        )
        sums = np.bincount(inverse.reshape(-1), bends.astype(np.float64), len(segments))
        return Borders(segments, lengths, sums / np.maximum(lengths, 1))


def gloss_groups(
    borders: Borders, log_likelihood: NDArray[np.float64], lab: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Join segments into materials.

    Args:
        borders: where the segments touch.
        log_likelihood: (S, K) of each segment's observations under each roughness; equal values
            where they hold no information.
        lab: (S, 3) each segment's L / 2, a, b.

    Returns:
        (S,) the material 0, 1, ... of each segment, by first segments.
    """
    segments = len(log_likelihood)
    surface = np.arange(segments)
    for (a, b), length, bend in zip(borders.segments, borders.lengths, borders.bends, strict=True):
        if length >= SHORTEST and bend <= SMOOTH:
            surface[find_root(surface, b)] = find_root(surface, a)
    surface = np.array([find_root(surface, k) for k in range(segments)], np.int64)
    material = np.arange(segments)
    for members in (np.flatnonzero(surface == root) for root in np.unique(surface)):
        _group_surface(members, borders, log_likelihood, lab, material)
    return renumbered(material)


def _group_surface(
    members: NDArray[np.int64],
    borders: Borders,
    log_likelihood: NDArray[np.float64],
    lab: NDArray[np.float64],
    material: NDArray[np.int64],
) -> None:
    """Write the materials of one smooth surface's segments into ``material``."""
    groups: list[list[int]] = []
    for segment in members.tolist():
        for group in groups:
            is_alike = np.linalg.norm(lab[segment] - lab[group[0]]) <= SAME_COLOUR
            if is_alike and _agree(log_likelihood, group, [segment]):
                group.append(segment)
                break
        else:
            groups.append([segment])
    touching = {tuple(pair) for pair in borders.segments.tolist()}
    merged = True
    while merged:
        merged = False
        for a, first in enumerate(groups):
            for b in range(a + 1, len(groups)):
                second = groups[b]
                recurs = len(first) + len(second) >= RECURRING and _alternate(
                    first, second, touching
                )
                if recurs and _agree(log_likelihood, first, second):
                    first.extend(second)
                    del groups[b]
                    merged = True
                    break
            if merged:
                break
    for group in groups:
        material[group] = min(group)


def _agree(log_likelihood: NDArray[np.float64], first: list[int], second: list[int]) -> bool:
    """Whether one roughness for both loses little."""
    a, b = log_likelihood[first].sum(axis=0), log_likelihood[second].sum(axis=0)
    return bool(a.max() + b.max() - (a + b).max() <= DISAGREEMENT)


def _alternate(first: list[int], second: list[int], touching: set[tuple[int, ...]]) -> bool:
    """Whether every segment of the more numerous group touches the other one."""
    many, few = (first, second) if len(first) >= len(second) else (second, first)
    return all(any((min(a, b), max(a, b)) in touching for b in few) for a in many)
