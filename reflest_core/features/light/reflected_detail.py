# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How sharp the reflections are, whatever is reflected: roughness told without knowing the light.

Observations that mirror one direction see one light. A polished surface shows many different
lights, and neighbouring directions apart: how much varies is great, and falls far as the cells of
mirrored directions shrink within which it is measured. A rough surface blurs: less varies, and
what does, hardly less so within small cells, for the direction alone does not decide it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.features.light.surface_sample import chosen_observations, towards_cameras
from reflest_core.fusion.observed_surface import ObservedSurface
from reflest_core.fusion.octahedral import octahedral_texel
from reflest_core.jit import compiled, kernel_array

OBSERVATIONS = 30
"""Of one voxel at most."""
CELLS = (6, 12, 24, 48, 96)
"""Along an edge of the octahedral map: from 34 to 2 degrees."""
DETAIL_STATISTICS = len(CELLS) + 1
STEEPEST = 0.35
"""Cosine to the normal, below which lobes are stretched too far to count."""
DARK = 0.05
"""Of the mean brightness: added to what a voxel shows above its darkest view."""
LEAST = 0.01
"""Added before the logarithm of a share."""


def reflected_detail(surface: ObservedSurface, voxels: NDArray[np.int64]) -> NDArray[np.float32]:
    """(6,) logarithms: the share of the variance within cells of each size, then how much varies.

    What varies is the logarithm of the brightness (the channels' mean) of ``voxels``, indices into
    ``surface``, above that in each one's darkest view. Every one of them is observed.
    """
    rows, voxel_of, _ = chosen_observations(surface, voxels, OBSERVATIONS)
    directions = towards_cameras(surface, rows, voxels[voxel_of])
    normals = surface.normals[voxels][voxel_of]
    cosine = np.einsum("ij,ij->i", normals, directions)
    shown = _above_darkest(srgb.LINEAR[surface.colours[rows]].mean(axis=1), voxel_of)
    mirrored = 2.0 * cosine[:, None] * normals - directions
    counts = cosine > STEEPEST
    mirrored = kernel_array(mirrored[counts], np.float32)
    shown = kernel_array(shown[counts], np.float32)
    variance = max(float(shown.var()), 1e-9) if len(shown) else 1e-9
    within = np.array([_variance_within(mirrored, shown, cells) for cells in CELLS])
    shares = np.clip(within / variance, 0.0, 2.0)
    return np.log(np.append(shares, np.sqrt(variance)) + LEAST).astype(np.float32)


def _above_darkest(
    brightness: NDArray[np.float32], voxel_of: NDArray[np.int64]
) -> NDArray[np.float32]:
    if not len(brightness):
        return brightness
    counts = np.bincount(voxel_of)
    darkest = np.minimum.reduceat(brightness, np.cumsum(counts) - counts)
    above = (brightness - darkest[voxel_of]) / max(float(brightness.mean()), 1e-6)
    return np.asarray(np.log(above + DARK))


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
