# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How sharp the reflections are, whatever is reflected: roughness told without knowing the light.

Observations that mirror one direction see one light. A polished surface tells neighbouring
directions apart, a rough one does not: so the variance that is left within cells of mirrored
directions falls as cells shrink, the earlier the rougher the surface.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.surface_sample import SurfaceSample
from reflest_core.fusion.octahedral import octahedral_texel
from reflest_core.jit import compiled, kernel_array

CELLS = (6, 12, 24, 48, 96)
"""Along an edge of the octahedral map: from 34 to 2 degrees."""
DETAIL_STATISTICS = len(CELLS) + 1
LEAST = 0.01
"""Added before a logarithm."""


def reflected_detail(sample: SurfaceSample) -> NDArray[np.float32]:
    """(6,) logarithms: the share of the variance within cells of each size, then how much varies.

    What varies is brightness, the mean of the channels, above each voxel's darkest view, in units of
    its mean.
    """
    if not len(sample.voxel_of):
        return np.zeros(DETAIL_STATISTICS, np.float32)
    brightness = sample.colours.mean(axis=1)
    darkest = np.full(len(sample.voxels), np.inf, brightness.dtype)
    np.minimum.at(darkest, sample.voxel_of, brightness)
    above = (brightness - darkest[sample.voxel_of]) / max(float(brightness.mean()), 1e-6)
    normals = sample.normals[sample.voxel_of]
    cosine = np.einsum("ij,ij->i", normals, sample.directions)
    mirrored = 2.0 * cosine[:, None] * normals - sample.directions
    variance = max(float(above.var()), 1e-9)
    within = [
        _variance_within(kernel_array(mirrored, np.float32), kernel_array(above, np.float32), cells)
        for cells in CELLS
    ]
    shares = np.minimum(np.array(within) / variance, 2.0)
    return np.log(np.append(shares, np.sqrt(variance)) + LEAST).astype(np.float32)


@compiled
def _variance_within(
    directions: NDArray[np.float32], values: NDArray[np.float32], cells: int
) -> float:
    """Mean squared deviation from the cell's mean, unbiased, over cells with company."""
    counts = np.zeros((cells, cells))
    sums = np.zeros((cells, cells))
    squares = np.zeros((cells, cells))
    for i in range(len(values)):
        row, column = octahedral_texel(directions[i, 0], directions[i, 1], directions[i, 2], cells)
        counts[row, column] += 1.0
        sums[row, column] += values[i]
        squares[row, column] += values[i] * values[i]
    deviation, freedom = 0.0, 1e-9
    for row in range(cells):
        for column in range(cells):
            if counts[row, column] > 1.0:
                deviation += squares[row, column] - sums[row, column] ** 2 / counts[row, column]
                freedom += counts[row, column] - 1.0
    return deviation / freedom
