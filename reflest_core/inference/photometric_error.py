# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How far a material, rendered in the light that goes with it, is from what was observed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.inference.transport.patch_grid import patches_of_texels
from reflest_core.inference.transport.surface_irradiance import SurfaceSight
from reflest_core.inference.transport.ward_lobe import half_vectors
from reflest_core.inference.voxel_albedo import (
    RINGS,
    SECTORS,
    Gloss,
    lobe_level,
    mirrored_radiance,
)
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.completion import LightPyramid
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.thinning import thinned

VOXELS, VIEWS = 256, 12
"""Voxels of a material and views of each that are rendered at most."""


def photometric_error(
    surface: ObservedSurface,
    voxels: NDArray[np.int64],
    rho_d: NDArray[np.float32],
    light: LightPyramid,
    sight: SurfaceSight,
    irradiance: NDArray[np.float32],
    gloss: Gloss,
) -> float:
    """Root mean square of rendered less observed linear colour, over the mean observed colour.

    Args:
        surface: V voxels with their observations.
        voxels: (N,) indices of the material's voxels.
        rho_d: (N, 3) the albedo of each, or (1, 3) of all.
        light: the completed light.
        sight: what all V voxels see of it.
        irradiance: (V, 3) ``E / pi`` under that light, linear.
        gloss: the material's.

    Returns:
        The error; NaN where nothing was observed. A clipped observation is met by any brighter
        rendering.
    """
    chosen = thinned(surface.observation_counts[voxels], VOXELS)
    level = light.levels[lobe_level(light, gloss.alpha)]
    squares, total, count = _sums(
        surface.positions,
        surface.normals,
        surface.offsets,
        surface.colours,
        surface.view_indices,
        surface.view_centres,
        kernel_array(voxels[chosen], np.int64),
        kernel_array(np.broadcast_to(rho_d, (len(voxels), 3))[chosen], np.float32),
        srgb.LINEAR,
        kernel_array(level.reshape(-1, 5), np.float32),
        patches_of_texels(len(level)),
        half_vectors((gloss.alpha,), RINGS, SECTORS)[0],
        sight.group_of,
        sight.sight.visible,
        sight.sight.own,
        kernel_array(irradiance, np.float32),
        gloss.rho_s,
    )
    if total == 0.0:
        return math.nan
    return math.sqrt(squares / count) / (total / count)


@compiled
def _sums(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    offsets: NDArray[np.int64],
    colours: NDArray[np.uint8],
    view_indices: NDArray[np.uint16],
    view_centres: NDArray[np.float32],
    voxels: NDArray[np.int64],
    rho_d: NDArray[np.float32],
    linear: NDArray[np.float32],
    light: NDArray[np.float32],
    patch_of: NDArray[np.int64],
    half: NDArray[np.float32],
    group_of: NDArray[np.int64],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
    irradiance: NDArray[np.float32],
    rho_s: float,
) -> tuple[float, float, int]:
    """Sums of squared errors and of colours, and how many values there are."""
    squares, total, values = 0.0, 0.0, 0
    weights, texels = np.empty(half.shape[1], np.float64), np.empty(half.shape[1], np.int32)
    mirrored = np.zeros(3)
    for i in range(len(voxels)):
        voxel, group = voxels[i], group_of[voxels[i]]
        first, count = offsets[voxel], offsets[voxel + 1] - offsets[voxel]
        taken = min(count, VIEWS)
        for k in range(taken):
            row = first + k * count // taken
            mirrored_radiance(
                positions[voxel],
                normals[voxel],
                view_centres[view_indices[row]],
                light,
                patch_of,
                half,
                visible[group],
                own[group],
                weights,
                texels,
                mirrored,
            )
            for channel in range(3):
                observed = linear[colours[row, channel]]
                model = rho_d[i, channel] * irradiance[voxel, channel] + rho_s * mirrored[channel]
                if colours[row, channel] == 255:
                    model = min(model, 1.0)
                squares += (model - observed) ** 2
                total += observed
                values += 1
    return squares, total, values
