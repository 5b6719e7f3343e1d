# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light in each observation's lobe, for roughnesses that differ from voxel to voxel.

An uncertain normal blurs the mean highlight: a voxel whose normal deviates by ``sigma`` about each
tangent axis reflects, in the mean, like one of roughness ``sqrt(alpha^2 + 2 sigma^2)``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.transport.mirrored_texels import fill_axes, texels_of_lobes
from reflest_core.jit import fused, kernel_array, vectorised
from reflest_core.light.completion import LightPyramid, halved

LEVELS = 4
"""Of the light's pyramid that lobes look into."""
RINGS, SECTORS = 5, 6
"""Half vectors of a lobe, stratified over it."""
SEEN, EXCESS = 3, 4
"""Columns: the share of a lobe's light that was seen; the first of three of clipped light."""
COLUMNS = 7


def lobe_light(
    light: LightPyramid,
    normals: NDArray[np.float32],
    voxel_of: NDArray[np.int64],
    directions: NDArray[np.float32],
    alphas: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Gather the light in O observations' lobes, as :func:`.lobe_radiance` does.

    Args:
        light: The completed light.
        normals: (V, 3) unit.
        voxel_of: (O,) rising, each observation's voxel.
        directions: (O, 3) unit, towards the camera.
        alphas: (V, K) roughnesses of each voxel.

    Returns:
        (K, O, 7): The radiance reflected at ``rho_s = 1`` in three channels; the share of the lobe
        that was seen; what clipped light adds to the radiance, in three channels, for each unit
        that it is above white.
    """
    if len(directions) == 0:
        return np.zeros((alphas.shape[1], 0, COLUMNS), np.float32)
    levels, excess = [], light.excess
    for level in light.levels[:LEVELS]:
        levels.append(np.concatenate([level[..., :4], excess], axis=-1).reshape(-1, COLUMNS))
        excess = halved(excess)
    offsets = np.cumsum([0, *(len(level) for level in levels)])
    return _gather(
        np.concatenate(levels).astype(np.float32),
        offsets,
        len(light.levels[0]),
        stratified_slopes(),
        kernel_array(normals, np.float32),
        kernel_array(voxel_of, np.int64),
        kernel_array(directions, np.float32),
        kernel_array(alphas, np.float64),
    )


def stratified_slopes(rings: int = RINGS, sectors: int = SECTORS) -> NDArray[np.float64]:
    """Stratify half vectors over a lobe: ``tan theta_h = alpha sqrt(-ln(1 - u))`` (Ward 1992).

    Args:
        rings: strata of ``u``.
        sectors: strata of the azimuth, each ring turned against the next.

    Returns:
        (2, S) slopes of half vectors along two tangents, in units of alpha.
    """
    ring, sector = np.meshgrid(np.arange(rings), np.arange(sectors), indexing="ij")
    turn = (2.0 * math.pi * (sector + 0.618 * ring) / sectors).ravel()
    slope = np.sqrt(-np.log(1.0 - (ring.ravel() + 0.5) / rings))
    return np.stack([slope * np.cos(turn), slope * np.sin(turn)])


@fused
def _gather(
    lights: NDArray[np.float32],
    offsets: NDArray[np.int64],
    edge: int,
    slopes: NDArray[np.float64],
    normals: NDArray[np.float32],
    voxel_of: NDArray[np.int64],
    directions: NDArray[np.float32],
    alphas: NDArray[np.float64],
) -> NDArray[np.float32]:
    samples, roughnesses = slopes.shape[1], alphas.shape[1]
    gathered = np.zeros((roughnesses, len(directions), COLUMNS), np.float32)
    half_vectors = np.zeros((3, roughnesses * samples), np.float32)
    sizes = np.zeros(roughnesses * samples, np.int32)
    firsts, texels = np.zeros_like(sizes), np.zeros_like(sizes)
    weights, axes = np.zeros(roughnesses * samples, np.float32), np.zeros((3, 3), np.float32)
    has_excess = lights[:, EXCESS:].max() > 0.0
    texel_width = math.sqrt(4.0 * math.pi) / edge
    voxel = -1
    for observation in range(len(directions)):
        if voxel_of[observation] != voxel:
            voxel = voxel_of[observation]
            fill_axes(normals[voxel], axes)
            for k in range(roughnesses):
                alpha = alphas[voxel, k]
                # Texels as wide as the samples' spacing about the mirrored direction.
                spacing = 4.0 * alpha / math.sqrt(samples)
                level = math.ceil(math.log2(max(spacing / texel_width, 1.0)))
                level = min(level, len(offsets) - 2)
                lobe = slice(k * samples, (k + 1) * samples)
                _fill_half_vectors(alpha, slopes, half_vectors[:, lobe])
                sizes[lobe], firsts[lobe] = edge >> level, offsets[level]
        texels_of_lobes(axes, directions[observation], half_vectors, sizes, firsts, weights, texels)
        for k in range(roughnesses):
            none = np.float32(0.0)
            mass, red, green, blue, seen = np.float32(1e-9), none, none, none, none
            for s in range(k * samples, (k + 1) * samples):
                texel, weight = texels[s], weights[s]
                mass += weight
                red += weight * lights[texel, 0]
                green += weight * lights[texel, 1]
                blue += weight * lights[texel, 2]
                seen += weight * lights[texel, SEEN]
            place = gathered[k, observation]
            place[0], place[1], place[2] = red / samples, green / samples, blue / samples
            place[SEEN] = seen / mass
            if has_excess:
                red, green, blue = none, none, none
                for s in range(k * samples, (k + 1) * samples):
                    texel, weight = texels[s], weights[s]
                    red += weight * lights[texel, EXCESS]
                    green += weight * lights[texel, EXCESS + 1]
                    blue += weight * lights[texel, EXCESS + 2]
                place[EXCESS], place[EXCESS + 1] = red / samples, green / samples
                place[EXCESS + 2] = blue / samples
    return gathered


@vectorised
def _fill_half_vectors(
    alpha: float, slopes: NDArray[np.float64], half_vectors: NDArray[np.float32]
) -> None:
    for s in range(slopes.shape[1]):
        x, y = alpha * slopes[0, s], alpha * slopes[1, s]
        scale = 1.0 / math.sqrt(1.0 + x * x + y * y)
        half_vectors[0, s] = x * scale
        half_vectors[1, s] = y * scale
        half_vectors[2, s] = scale
