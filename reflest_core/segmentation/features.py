# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What voxels are compared by: colour over irradiance in Lab, contrast over views, and normals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.apparent_albedo import albedo_to_lab, apparent_albedo
from reflest_core.jit import compiled, kernel_array
from reflest_core.segmentation.statistics import VoxelColours

CONTRAST = 15.0
"""Units of Lab for a factor e between bright and dark views."""
ROUNDS, SHARPNESS, BEND = 2, 4.0, 0.5
"""Of the smoothing over neighbours: how often, and the distances in feature space and between unit
normals at which a neighbour loses its weight."""
CREASE, CREASE_FROM = 6.0, 0.25
"""Units of Lab for a concave crease, and the least one: sine of the angle between the surfaces."""


@dataclass(frozen=True)
class VoxelFeatures:
    """Features of V voxels and of E pairs of neighbours.

    Attributes:
        values: (V, 4) float64, L / 2, a, b of the apparent albedo and the weighted contrast,
            smoothed over neighbours.
        differences: (E,) float32, dissimilarity of each pair, with creases.
    """

    values: NDArray[np.float64]
    differences: NDArray[np.float32]


def voxel_features(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    pairs: NDArray[np.int32],
    colours: VoxelColours,
    irradiance: NDArray[np.float32],
) -> VoxelFeatures:
    """Compute what the graph segmentation compares.

    Args:
        positions: (V, 3) metres.
        normals: (V, 3) unit.
        pairs: (E, 2) neighbours.
        colours: quantiles over the views, linear.
        irradiance: (V, 3) ``E / pi``, linear, in the colours' units.

    Returns:
        Features of voxels and pairs.
    """
    lab = albedo_to_lab(apparent_albedo(colours.low, irradiance))
    rough = np.concatenate([lab, CONTRAST * colours.contrast[:, None]], axis=1)
    values, differences = _smoothed_and_compared(
        kernel_array(positions, np.float32),
        kernel_array(normals, np.float32),
        kernel_array(pairs, np.int32),
        kernel_array(rough, np.float64),
    )
    return VoxelFeatures(values, differences)


@compiled
def _smoothed_and_compared(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    pairs: NDArray[np.int32],
    values: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    voxels, width = values.shape
    concave = np.empty(len(pairs), np.float32)
    weights = np.empty(len(pairs), np.float32)
    for edge in range(len(pairs)):
        i, j = pairs[edge]
        bend, along, length, apart = 0.0, 0.0, 0.0, 0.0
        for axis in range(3):
            turn = normals[i, axis] - normals[j, axis]
            step = positions[j, axis] - positions[i, axis]
            bend += turn * turn
            along += turn * step
            length += step * step
        for k in range(width):
            apart += (values[i, k] - values[j, k]) ** 2
        concave[edge] = along / np.sqrt(max(length, 1e-12))
        closeness = apart / (4.0 * SHARPNESS * SHARPNESS) + bend / (BEND * BEND)
        weights[edge] = np.exp(-closeness)
    for _ in range(ROUNDS):
        sums, totals = values.copy(), np.ones(voxels)
        for edge in range(len(pairs)):
            i, j = pairs[edge]
            weight = weights[edge]
            for k in range(width):
                sums[i, k] += weight * values[j, k]
                sums[j, k] += weight * values[i, k]
            totals[i] += weight
            totals[j] += weight
        for voxel in range(voxels):
            for k in range(width):
                values[voxel, k] = sums[voxel, k] / totals[voxel]
    differences = np.empty(len(pairs), np.float32)
    for edge in range(len(pairs)):
        i, j = pairs[edge]
        apart = 0.0
        for k in range(width):
            apart += (values[i, k] - values[j, k]) ** 2
        crease = max(concave[edge] - CREASE_FROM, 0.0)
        differences[edge] = np.sqrt(apart) + CREASE * crease
    return values, differences
