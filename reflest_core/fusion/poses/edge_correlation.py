# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Correlations of many frames' edges with each other, and edges with a zoom undone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, vectorised

Image = NDArray[np.float32]

PIXELS = 64
"""Pixels of all frames that are laid out for one another at a time: they stay in the cache."""
LANES = 32
"""Sums are padded to whole times so many, which vector instructions take at once."""


def correlations(depth: Image, colour: Image) -> NDArray[np.float32]:
    """Correlate the edges of each frame's depth with those of each frame's colours.

    A matrix product would wake BLAS' threads; and most of a frame is far from any edge of depth.

    Args:
        depth: (M, h, w) edges, each of length 1 or 0.
        colour: (N, h, w) the same.

    Returns:
        (M, N) a frame's depth along the rows.
    """
    return _correlations(depth.reshape(len(depth), -1), colour.reshape(len(colour), -1))


def zoomed(images: Image, zoom: tuple[float, float]) -> Image:
    """Undo a zoom about the middle.

    Args:
        images: (N, h, w).
        zoom: Factors across and down.

    Returns:
        (N, h, w); what lies outside is 0.
    """
    height, width = images.shape[1:]
    return _taken(images, _sources(height, zoom[1]), _sources(width, zoom[0]))


def _sources(count: int, factor: float) -> NDArray[np.int64]:
    """Which row or column each one is taken from; -1 for none."""
    middle = (count - 1) / 2
    found = np.round((np.arange(count) - middle) * factor + middle).astype(np.int64)
    return np.where((found >= 0) & (found < count), found, -1)


@vectorised
def _correlations(depth: NDArray[np.float32], colour: NDArray[np.float32]) -> NDArray[np.float32]:
    count, size = colour.shape
    padded = (count + LANES - 1) // LANES * LANES
    totals = np.zeros((len(depth), padded))
    sums = np.empty(padded, np.float32)
    beside = np.zeros((PIXELS, padded), np.float32)
    for first in range(0, size, PIXELS):
        last = min(first + PIXELS, size)
        for frame in range(count):
            for pixel in range(first, last):
                beside[pixel - first, frame] = colour[frame, pixel]
        for frame in range(len(depth)):
            sums[:] = np.float32(0.0)
            for pixel in range(first, last):
                weight, of_pixel = depth[frame, pixel], pixel - first
                if weight == np.float32(0.0):
                    continue
                for other in range(padded):
                    sums[other] += weight * beside[of_pixel, other]
            for other in range(padded):
                totals[frame, other] += sums[other]
    return totals[:, :count].astype(np.float32)


@compiled
def _taken(
    images: NDArray[np.float32], rows: NDArray[np.int64], columns: NDArray[np.int64]
) -> NDArray[np.float32]:
    found = np.zeros(images.shape, np.float32)
    for image in range(len(images)):
        for row in range(len(rows)):
            if rows[row] < 0:
                continue
            for column in range(len(columns)):
                if columns[column] >= 0:
                    found[image, row, column] = images[image, rows[row], columns[column]]
    return found
