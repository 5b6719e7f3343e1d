# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Voxel hemisphere images, the input of HemiCNN (section 3.3.1, Figure 3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.tangent_frame import tangent_frame

SIZE = 10
"""Rows and columns of a hemisphere image."""


def hemisphere_images(
    surface: ObservedSurface, voxels: NDArray[np.int64], azimuths: NDArray[np.float64] | None = None
) -> NDArray[np.float32]:
    """Make the images of voxels.

    Each observation is projected onto the tangent plane's unit disc; a pixel takes the colour of
    the nearest one. Column follows the tangent, row the bitangent, of :func:`tangent_frame`. A
    voxel without an observation on its positive hemisphere is black.

    Args:
        surface: A scan, or a material's part of one, upright (+z is up).
        voxels: (N,) indices of voxels, all observed.
        azimuths: (N,) radians, turns about the normal, with which training augments; None for
            none.

    Returns:
        (N, 3, 10, 10) float32, 8-bit sRGB / 255.
    """
    if azimuths is None:
        azimuths = np.zeros(len(voxels))
    images = np.zeros((len(voxels), 3, SIZE, SIZE), np.float32)
    _fill(
        surface.positions,
        surface.normals,
        surface.offsets,
        surface.colours,
        surface.view_indices,
        surface.view_centres,
        voxels,
        azimuths,
        images,
    )
    return images


@compiled
def _fill(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    offsets: NDArray[np.int64],
    colours: NDArray[np.uint8],
    view_indices: NDArray[np.uint16],
    view_centres: NDArray[np.float32],
    voxels: NDArray[np.int64],
    azimuths: NDArray[np.float64],
    images: NDArray[np.float32],
) -> None:
    for n in range(len(voxels)):
        voxel = voxels[n]
        normal = normals[voxel]
        tx, ty, tz, bx, by, bz = tangent_frame(normal)
        cos_turn, sin_turn = np.cos(azimuths[n]), np.sin(azimuths[n])
        first, last = offsets[voxel], offsets[voxel + 1]
        disc = np.empty((last - first, 2))
        owner = np.empty(last - first, np.int64)
        count = 0
        for index in range(first, last):
            centre = view_centres[view_indices[index]]
            dx = centre[0] - positions[voxel, 0]
            dy = centre[1] - positions[voxel, 1]
            dz = centre[2] - positions[voxel, 2]
            if dx * normal[0] + dy * normal[1] + dz * normal[2] <= 0:
                continue
            length = np.sqrt(dx * dx + dy * dy + dz * dz)
            x = (dx * tx + dy * ty + dz * tz) / length
            y = (dx * bx + dy * by + dz * bz) / length
            disc[count, 0] = cos_turn * x - sin_turn * y
            disc[count, 1] = sin_turn * x + cos_turn * y
            owner[count] = index
            count += 1
        if count == 0:
            continue
        for row in range(SIZE):
            y = (row + 0.5) * 2 / SIZE - 1
            for column in range(SIZE):
                x = (column + 0.5) * 2 / SIZE - 1
                nearest, nearest_squared = 0, 1e9
                for k in range(count):
                    squared = (disc[k, 0] - x) ** 2 + (disc[k, 1] - y) ** 2
                    if squared < nearest_squared:
                        nearest, nearest_squared = k, squared
                for channel in range(3):
                    images[n, channel, row, column] = colours[owner[nearest], channel] / 255.0
