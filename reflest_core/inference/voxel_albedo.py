# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The diffuse albedo of single voxels, in closed form, given the light and the material's gloss.

An observation is ``L = rho_d E(n) / pi + rho_s S(o, n, alpha)``. With ``E``, ``S``, ``rho_s`` and
``alpha`` given, ``rho_d`` is a weighted mean; the material's own is its prior. Dark views of a
voxel are used, for they hold least of what is mirrored.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.inference.transport.mirrored_texels import mirrored_texels
from reflest_core.inference.transport.patch_grid import patches_of_texels
from reflest_core.inference.transport.surface_irradiance import SurfaceSight
from reflest_core.inference.transport.ward_lobe import half_vectors
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.completion import LightPyramid
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.tangent_frame import tangent_frame

RANKS = (0.15, 0.3, 0.45, 0.6)
"""Of a voxel's views by brightness: those that are used."""
MOST_RANKED = 64
"""Observations of a voxel that are ranked, taken evenly."""
RELATIVE, LEAST = 0.05, 0.003
"""Standard deviation of a radiance: share of itself, and in units of the sensor's white."""
REFLECTED = 0.3
"""The same of what is mirrored, as a share of it."""
SHADING = 0.08
"""The same of a voxel's irradiance beside its neighbours', as a share: normals err."""
LEAST_IRRADIANCE = 1e-3
"""``E / pi`` in units of the sensor's white."""
RINGS, SECTORS = 5, 4
"""Half vectors of a lobe."""


@dataclass(frozen=True)
class Gloss:
    """The gloss of one material.

    Attributes:
        rho_s: specular albedo.
        alpha: roughness.
    """

    rho_s: float
    alpha: float


@dataclass(frozen=True)
class VoxelAlbedo:
    """The diffuse albedo of N voxels.

    Attributes:
        rho_d: (N, 3) float32, linear sRGB in [0, 1].
        deviation: (N, 3) float32, standard deviation beside the material's: the light's scale is
            not in it, for it is common to all voxels.
    """

    rho_d: NDArray[np.float32]
    deviation: NDArray[np.float32]


def voxel_albedo(
    surface: ObservedSurface,
    voxels: NDArray[np.int64],
    light: LightPyramid,
    sight: SurfaceSight,
    irradiance: NDArray[np.float32],
    gloss: Gloss,
) -> VoxelAlbedo:
    """Compute ``rho_d`` of the voxels of one material.

    Args:
        surface: V voxels with their observations.
        voxels: (N,) indices of the material's voxels.
        light: the completed light.
        sight: what all V voxels see of it.
        irradiance: (V, 3) ``E / pi`` under that light, linear.
        gloss: the material's.

    Returns:
        Albedos, shrunk to the material's median where little was seen.
    """
    level = light.levels[lobe_level(light, gloss.alpha)]
    sums, weights = _weighted_sums(
        surface.positions,
        surface.normals,
        surface.offsets,
        surface.colours,
        surface.view_indices,
        surface.view_centres,
        kernel_array(voxels, np.int64),
        srgb.LINEAR,
        kernel_array(level.reshape(-1, 5), np.float32),
        patches_of_texels(len(level)),
        half_vectors((gloss.alpha,), RINGS, SECTORS)[0],
        sight.group_of,
        sight.sight.visible,
        sight.sight.own,
        kernel_array(irradiance, np.float32),
        gloss.rho_s,
        np.array(RANKS),
    )
    is_known = weights > 0.0
    alone = np.where(is_known, sums / np.where(is_known, weights, 1.0), np.nan)
    usual = np.zeros(3)
    scatter = np.full(3, 1e-3)
    for channel in range(3):
        known = alone[is_known[:, channel], channel]
        if len(known):
            usual[channel] = np.median(known)
            scatter[channel] = max(1.4826 * float(np.median(np.abs(known - usual[channel]))), 1e-3)
    precision = scatter**-2.0
    # Views of a voxel share its irradiance, and what is wrong with it.
    own = np.where(
        is_known, 1.0 / (1.0 / np.where(is_known, weights, 1.0) + (SHADING * alone) ** 2), 0.0
    )
    total = own + precision
    shrunk = (own * np.where(is_known, alone, 0.0) + precision * usual) / total
    return VoxelAlbedo(
        np.clip(shrunk, 0.0, 1.0).astype(np.float32), np.sqrt(1.0 / total).astype(np.float32)
    )


def lobe_level(light: LightPyramid, alpha: float) -> int:
    """Choose the pyramid's level whose texels are about as wide as the spacing of a lobe's samples.

    Args:
        light: the pyramid.
        alpha: roughness.
    """
    spacing = 4.0 * alpha / math.sqrt(RINGS * SECTORS)
    texel = math.sqrt(4.0 * math.pi) / len(light.levels[0])
    return int(np.clip(math.log2(max(spacing / texel, 1.0)), 0, 2))


@compiled
def mirrored_radiance(
    position: NDArray[np.float32],
    normal: NDArray[np.float32],
    camera: NDArray[np.float32],
    light: NDArray[np.float32],
    patch_of: NDArray[np.int64],
    half: NDArray[np.float32],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
    weights: NDArray[np.float64],
    texels: NDArray[np.int32],
    radiance: NDArray[np.float64],
) -> None:
    """What one observation mirrors at ``rho_s = 1``, into ``radiance`` (3,).

    Args:
        position: (3,) metres.
        normal: (3,) unit.
        camera: (3,) metres.
        light: (N * N, 5) a level of the pyramid.
        patch_of: (N * N,) the patch of each texel.
        half: (3, S) half vectors in the tangent frame.
        visible: (P,) share of each patch that arrives.
        own: (P, 3) radiance from where it does not.
        weights: (S,) scratch.
        texels: (S,) scratch.
        radiance: (3,) the result.
    """
    size, samples = int(math.sqrt(len(light))), half.shape[1]
    dx, dy, dz = camera[0] - position[0], camera[1] - position[1], camera[2] - position[2]
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    if length == 0.0:  # a camera on the voxel looks along the normal
        dx, dy, dz = normal[0], normal[1], normal[2]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
    frame = tangent_frame(normal)
    n = (float(normal[0]), float(normal[1]), float(normal[2]))
    mirrored_texels(frame, n, (dx / length, dy / length, dz / length), half, size, weights, texels)
    radiance[:] = 0.0
    for sample in range(samples):
        texel = texels[sample]
        patch = patch_of[texel]
        arriving = weights[sample] * visible[patch]
        hidden = weights[sample] - arriving
        for channel in range(3):
            radiance[channel] += arriving * light[texel, channel] + hidden * own[patch, channel]
    radiance /= samples


@compiled
def _weighted_sums(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    offsets: NDArray[np.int64],
    colours: NDArray[np.uint8],
    view_indices: NDArray[np.uint16],
    view_centres: NDArray[np.float32],
    voxels: NDArray[np.int64],
    linear: NDArray[np.float32],
    light: NDArray[np.float32],
    patch_of: NDArray[np.int64],
    half: NDArray[np.float32],
    group_of: NDArray[np.int64],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
    irradiance: NDArray[np.float32],
    rho_s: float,
    ranks: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(N, 3) sums of weight times albedo, and of weights, over the chosen views."""
    sums, totals = np.zeros((len(voxels), 3)), np.zeros((len(voxels), 3))
    brightness = np.empty(MOST_RANKED, np.float32)
    rows = np.empty(MOST_RANKED, np.int64)
    weights, texels = np.empty(half.shape[1], np.float64), np.empty(half.shape[1], np.int32)
    mirrored = np.zeros(3)
    for i in range(len(voxels)):
        voxel = voxels[i]
        first, count = offsets[voxel], offsets[voxel + 1] - offsets[voxel]
        taken = min(count, MOST_RANKED)
        for k in range(taken):
            row = first + k * count // taken
            colour = colours[row]
            value = linear[colour[0]] + linear[colour[1]] + linear[colour[2]]
            place = k
            while place > 0 and brightness[place - 1] > value:
                brightness[place], rows[place] = brightness[place - 1], rows[place - 1]
                place -= 1
            brightness[place], rows[place] = value, row
        last = -1
        for rank in ranks:
            place = int(rank * taken)
            if place >= taken or place == last:
                continue
            last = place
            row = rows[place]
            if rho_s > 0.0:
                group = group_of[voxel]
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
                if colours[row, channel] == 255:
                    continue
                radiance = linear[colours[row, channel]]
                shine = rho_s * mirrored[channel]
                white = max(irradiance[voxel, channel], LEAST_IRRADIANCE)
                deviation = math.hypot(RELATIVE * radiance + LEAST, REFLECTED * shine) / white
                weight = 1.0 / (deviation * deviation)
                sums[i, channel] += weight * max(radiance - shine, 0.0) / white
                totals[i, channel] += weight
    return sums, totals
