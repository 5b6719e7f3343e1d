# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How sharp the reflections are, whatever is reflected: roughness without knowing the light.

Observations that mirror one direction see one light. A polished surface shows many different
lights, and neighbouring directions apart: how much varies is great, and falls far as the cells of
mirrored directions shrink within which it is measured. A rough surface blurs: less varies, and
what does, hardly less so within small cells, for the direction alone does not decide it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.inference.transport.mirrored_texels import vector
from reflest_core.jit import compiled
from reflest_core.light.octahedral import octahedral_texel
from reflest_core.surface.observed_surface import ObservedSurface

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
    """Measure how finely reflections vary with the mirrored direction.

    What varies is the logarithm of the brightness (the channels' mean) of a voxel above that in its
    darkest view.

    Args:
        surface: with observations.
        voxels: (V,) indices into it, each observed.

    Returns:
        (6,) float32 logarithms: the share of the variance within cells of each size, then the
        standard deviation.
    """
    mirrored, above, brightness = _above_darkest(
        surface.positions,
        surface.normals,
        surface.offsets,
        surface.colours,
        surface.view_indices,
        surface.view_centres,
        voxels,
        srgb.LINEAR,
    )
    shown = np.log(above / np.float32(max(brightness, 1e-6)) + np.float32(DARK))
    variance = max(float(shown.var()), 1e-9) if len(shown) else 1e-9
    within = np.array([_variance_within(mirrored, shown, cells) for cells in CELLS])
    shares = np.clip(within / variance, 0.0, 2.0)
    return np.log(np.append(shares, np.sqrt(variance)) + LEAST).astype(np.float32)


@compiled
def _above_darkest(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    offsets: NDArray[np.int64],
    colours: NDArray[np.uint8],
    view_indices: NDArray[np.uint16],
    view_centres: NDArray[np.float32],
    voxels: NDArray[np.int64],
    linear: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32], float]:
    """Of M observations that count: mirrored directions (M, 3) and brightness above the darkest.

    And the mean brightness of all that were looked at.
    """
    mirrored = np.empty((len(voxels) * OBSERVATIONS, 3), np.float32)
    above = np.empty(len(voxels) * OBSERVATIONS, np.float32)
    shown = np.empty(OBSERVATIONS, np.float32)
    total, looked_at, kept = 0.0, 0, 0
    for voxel in voxels:
        first, count = offsets[voxel], offsets[voxel + 1] - offsets[voxel]
        taken = min(count, OBSERVATIONS)
        for slot in range(taken):
            colour = colours[first + slot * count // taken]
            shown[slot] = (linear[colour[0]] + linear[colour[1]] + linear[colour[2]]) / 3.0
            total += shown[slot]
        looked_at += taken
        darkest = shown[:taken].min()
        nx, ny, nz = vector(normals, voxel)
        px, py, pz = vector(positions, voxel)
        for slot in range(taken):
            cx, cy, cz = vector(view_centres, view_indices[first + slot * count // taken])
            dx, dy, dz = cx - px, cy - py, cz - pz
            length = math.sqrt(dx * dx + dy * dy + dz * dz)
            cosine = (dx * nx + dy * ny + dz * nz) / length
            if length > 0.0 and cosine > STEEPEST:
                mirrored[kept, 0] = 2.0 * cosine * nx - dx / length
                mirrored[kept, 1] = 2.0 * cosine * ny - dy / length
                mirrored[kept, 2] = 2.0 * cosine * nz - dz / length
                above[kept] = shown[slot] - darkest
                kept += 1
    return mirrored[:kept], above[:kept], total / max(looked_at, 1)


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
