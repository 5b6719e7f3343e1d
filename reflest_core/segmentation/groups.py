# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Gloss groups: segments of one surface whose gloss agrees are one material of several colours.

A texture divides a surface into segments of few colours that recur side by side. Segments are
grouped where three things hold: they lie on one smooth surface, their posteriors of roughness
agree, and their colours are alike or alternate.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.segmentation.graph import find_root, renumbered

INERTIA = 1.5
"""Factor on all limits in favour of the earlier division."""
SMOOTH = 0.25
"""Mean distance of unit normals across a border, up to which two segments are one surface."""
SHORTEST = 8
"""Pairs of voxels of the shortest border."""
DISAGREEMENT = 4.0
"""Loss of log-likelihood, by one roughness for both, up to which two posteriors agree."""
SAME_COLOUR = 6.0
"""Distance in Lab (with L halved) up to which two colours are one."""
RECURRING = 4
"""Segments of two colours together, at least one of each, from which they are a texture."""
TOUCHING = 0.75
"""Share of the more numerous colour's voxels whose segments touch the other colour."""
EVEN = 0.1
"""Share of the larger colour's voxels that the smaller has at least, for its border to count."""
INTERLEAVED = 2.4
"""Length of a border, over the root of the smaller side's voxels, from which two colours are a
texture: two halves of a ball have 1, a band around it has 2. The length is in pairs of voxels over
the mean number of a voxel's neighbours."""


@dataclass(frozen=True)
class Borders:
    """Where segments touch.

    Attributes:
        segments: (B, 2) int64, the two segments of each border, the smaller label first.
        lengths: (B,) int64, pairs of neighbouring voxels across it.
        bends: (B,) float64, mean distance of unit normals across it.
        neighbours: mean number of neighbours of all voxels.
    """

    segments: NDArray[np.int64]
    lengths: NDArray[np.int64]
    bends: NDArray[np.float64]
    neighbours: float

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
        neighbours = 2.0 * len(pairs) / max(len(labels), 1)
        return Borders(segments, lengths, sums / np.maximum(lengths, 1), neighbours)


def gloss_groups(
    borders: Borders,
    sizes: NDArray[np.int64],
    log_likelihood: NDArray[np.float64],
    lab: NDArray[np.float64],
    before: NDArray[np.int64] | None = None,
) -> NDArray[np.int64]:
    """Join segments into materials.

    Args:
        borders: where the segments touch.
        sizes: (S,) voxels of each segment.
        log_likelihood: (S, K) of each segment's observations under each roughness; equal values
            where they hold no information.
        lab: (S, 3) each segment's L / 2, a, b.
        before: (S,) the material that most of each segment had in an earlier division, -1 for new
            ones: what was together tends to stay together, and what was apart, apart.

    Returns:
        (S,) the material 0, 1, ... of each segment, by first segments.
    """
    segments = len(log_likelihood)
    before = np.full(segments, -1) if before is None else before
    lengths = {
        (a, b): length / borders.neighbours
        for (a, b), length in zip(borders.segments.tolist(), borders.lengths.tolist(), strict=True)
    }
    judge = _Judge(lengths, sizes, log_likelihood, lab, before)
    surface = np.arange(segments)
    for (a, b), length, bend in zip(borders.segments, borders.lengths, borders.bends, strict=True):
        if length >= SHORTEST and bend <= SMOOTH:
            surface[find_root(surface, b)] = find_root(surface, a)
    surface = np.array([find_root(surface, k) for k in range(segments)], np.int64)
    material = np.arange(segments)
    for members in (np.flatnonzero(surface == root) for root in np.unique(surface)):
        for group in judge.grouped(members.tolist()):
            material[group] = min(group)
    return renumbered(material)


@dataclass(frozen=True)
class _Judge:
    """Decides which segments of one smooth surface are one material."""

    lengths: dict[tuple[int, int], float]
    sizes: NDArray[np.int64]
    log_likelihood: NDArray[np.float64]
    lab: NDArray[np.float64]
    before: NDArray[np.int64]

    def grouped(self, members: list[int]) -> list[list[int]]:
        """Divide segments into materials: first by colour, the largest first, then by texture."""
        groups: list[list[int]] = []
        for segment in sorted(members, key=lambda member: (-self.sizes[member], member)):
            for group in groups:
                if self._is_alike(group, [segment]) and self._agree(group, [segment]):
                    group.append(segment)
                    break
            else:
                groups.append([segment])
        merged = True
        while merged:
            merged = False
            for a, b in itertools.combinations(range(len(groups)), 2):
                first, second = groups[a], groups[b]
                if self._alternate(first, second) and self._agree(first, second):
                    first.extend(second)
                    del groups[b]
                    merged = True
                    break
        return groups

    def _lenience(self, first: list[int], second: list[int]) -> float:
        a, b = self.before[first[0]], self.before[second[0]]
        if a < 0 or b < 0:
            return 1.0
        return INERTIA if a == b else 1.0 / INERTIA

    def _is_alike(self, first: list[int], second: list[int]) -> bool:
        distance = float(np.linalg.norm(self.lab[first[0]] - self.lab[second[0]]))
        return distance <= SAME_COLOUR * self._lenience(first, second)

    def _agree(self, first: list[int], second: list[int]) -> bool:
        """Whether one roughness for both loses little."""
        a, b = (self.log_likelihood[group].sum(axis=0) for group in (first, second))
        loss = float(a.max() + b.max() - (a + b).max())
        return loss <= DISAGREEMENT * self._lenience(first, second)

    def _alternate(self, first: list[int], second: list[int]) -> bool:
        """Whether two groups of segments are side by side again and again."""
        between = np.array(
            [[self.lengths.get((min(a, b), max(a, b)), 0.0) for b in second] for a in first]
        )
        sizes, lenience = self.sizes, self._lenience(first, second)
        smaller, larger = sorted((int(sizes[first].sum()), int(sizes[second].sum())))
        is_even = smaller * lenience >= EVEN * larger
        is_fine = between.sum() * lenience >= INTERLEAVED * math.sqrt(smaller)
        many, of_many = (between, first) if len(first) >= len(second) else (between.T, second)
        touches = many.any(axis=1)
        touching = sizes[of_many][touches].sum() / max(int(sizes[of_many].sum()), 1)
        recurs = int(touches.sum()) + min(len(first), len(second)) >= RECURRING / lenience
        return bool((is_even and is_fine) or (recurs and touching * lenience >= TOUCHING))
