# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scraps: pieces too small to be a segment join the neighbour that they resemble most."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reflest_core.jit import compiled
from reflest_core.segmentation.graph import find_root, renumbered

PLACE, LIKENESS = 0.01, 5.0
"""Metres and units of Lab that count alike where a piece touches no segment."""


def attach_scraps(
    labels: NDArray[np.int64],
    pairs: NDArray[np.int32],
    differences: NDArray[np.float32],
    positions: NDArray[np.float32],
    values: NDArray[np.float64],
    least: int,
) -> NDArray[np.int64]:
    """Join segments of fewer than ``least`` voxels to others.

    Along the borders, lightest first, a scrap joins what it touches; two scraps that together reach
    ``least`` become a segment of their own. What touches nothing joins the nearest segment by
    position and features.

    Args:
        labels: (V,) segments 0, 1, ...
        pairs: (E, 2) neighbouring voxels.
        differences: (E,) dissimilarity of each pair.
        positions: (V, 3) metres.
        values: (V, F) features in units of Lab.
        least: voxels of the smallest segment that stays.

    Returns:
        (V,) labels 0, 1, ... in the order of first voxels.
    """
    segments = int(labels.max(initial=-1)) + 1
    means = _border_means(labels, pairs, differences)
    joined = _joined(labels, *means, segments, least)
    counts = np.bincount(joined, minlength=1)
    is_large = counts[joined] >= least
    if is_large.any() and not is_large.all():
        points = np.concatenate([positions / PLACE, values / LIKENESS], axis=1)
        _, nearest = cKDTree(points[is_large]).query(points[~is_large])
        joined[~is_large] = joined[is_large][nearest]
    return renumbered(joined)


def _border_means(
    labels: NDArray[np.int64], pairs: NDArray[np.int32], differences: NDArray[np.float32]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Touching segments (B,), (B,) and the mean difference across each border, lightest first."""
    ends = np.sort(labels[pairs], axis=1)
    crosses = np.flatnonzero(ends[:, 0] != ends[:, 1])
    segments = int(labels.max(initial=-1)) + 1
    codes, inverse = np.unique(ends[crosses, 0] * segments + ends[crosses, 1], return_inverse=True)
    lengths = np.bincount(inverse, minlength=len(codes))
    sums = np.bincount(inverse, differences[crosses].astype(np.float64), len(codes))
    means = sums / np.maximum(lengths, 1)
    order = np.argsort(means, kind="stable")
    return codes[order] // max(segments, 1), codes[order] % max(segments, 1), means[order]


@compiled
def _joined(
    labels: NDArray[np.int64],
    first: NDArray[np.int64],
    second: NDArray[np.int64],
    means: NDArray[np.float64],
    segments: int,
    least: int,
) -> NDArray[np.int64]:
    parents = np.arange(segments)
    sizes = np.zeros(segments, np.int64)
    for label in labels:
        sizes[label] += 1
    for border in range(len(means)):
        a, b = find_root(parents, first[border]), find_root(parents, second[border])
        if a != b and (sizes[a] < least or sizes[b] < least):
            parents[b] = a
            sizes[a] += sizes[b]
    joined = np.empty(len(labels), np.int64)
    for voxel in range(len(labels)):
        joined[voxel] = find_root(parents, labels[voxel])
    return joined
