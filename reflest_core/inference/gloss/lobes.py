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

from reflest_core.jit import compiled, kernel_array, vectorised
from reflest_core.light.completion import LightPyramid, halved
from reflest_core.surface.tangent_frame import tangent_frame

LEVELS = 4
"""Of the light's pyramid that lobes look into."""
RINGS, SECTORS = 6, 8
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


@compiled
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
    half_vectors = np.zeros((roughnesses, 3, samples), np.float32)
    level_of = np.zeros(roughnesses, np.int64)
    weights, texels = np.zeros(samples, np.float32), np.zeros(samples, np.int32)
    has_excess = lights[:, EXCESS:].max() > 0.0
    axes = np.zeros((3, 3), np.float32)
    texel_width = math.sqrt(4.0 * math.pi) / edge
    voxel = -1
    for observation in range(len(directions)):
        if voxel_of[observation] != voxel:
            voxel = voxel_of[observation]
            tx, ty, tz, bx, by, bz = tangent_frame(normals[voxel])
            axes[0, 0], axes[0, 1], axes[0, 2] = tx, ty, tz
            axes[1, 0], axes[1, 1], axes[1, 2] = bx, by, bz
            axes[2] = normals[voxel]
            for k in range(roughnesses):
                alpha = alphas[voxel, k]
                for s in range(samples):
                    x, y = alpha * slopes[0, s], alpha * slopes[1, s]
                    scale = 1.0 / math.sqrt(1.0 + x * x + y * y)
                    half_vectors[k, 0, s] = x * scale
                    half_vectors[k, 1, s] = y * scale
                    half_vectors[k, 2, s] = scale
                # Texels as wide as the samples' spacing about the mirrored direction.
                spacing = 4.0 * alpha / math.sqrt(samples)
                level = math.ceil(math.log2(max(spacing / texel_width, 1.0)))
                level_of[k] = min(level, len(offsets) - 2)
        for k in range(roughnesses):
            level = level_of[k]
            _sampled_texels(
                axes, directions[observation], half_vectors[k], edge >> level, weights, texels
            )
            none = np.float32(0.0)
            mass, red, green, blue, seen = np.float32(1e-9), none, none, none, none
            for s in range(samples):
                texel, weight = offsets[level] + texels[s], weights[s]
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
                for s in range(samples):
                    texel, weight = offsets[level] + texels[s], weights[s]
                    red += weight * lights[texel, EXCESS]
                    green += weight * lights[texel, EXCESS + 1]
                    blue += weight * lights[texel, EXCESS + 2]
                place[EXCESS], place[EXCESS + 1] = red / samples, green / samples
                place[EXCESS + 2] = blue / samples
    return gathered


@vectorised
def _sampled_texels(
    axes: NDArray[np.float32],
    towards_camera: NDArray[np.float32],
    half_vectors: NDArray[np.float32],
    size: int,
    weights: NDArray[np.float32],
    texels: NDArray[np.int32],
) -> None:
    """:func:`.mirrored_texels` in single precision, which takes half the time.

    ``axes``: (3, 3) tangent, bitangent and normal.
    """
    zero, half, one, two = np.float32(0.0), np.float32(0.5), np.float32(1.0), np.float32(2.0)
    x = axes[0, 0] * towards_camera[0] + axes[0, 1] * towards_camera[1]
    x += axes[0, 2] * towards_camera[2]
    y = axes[1, 0] * towards_camera[0] + axes[1, 1] * towards_camera[1]
    y += axes[1, 2] * towards_camera[2]
    z = axes[2, 0] * towards_camera[0] + axes[2, 1] * towards_camera[1]
    z += axes[2, 2] * towards_camera[2]
    inverse = one / max(z, np.float32(1e-3))
    scale_of_map = half * np.float32(size)
    last = np.int32(size - 1)
    for s in range(len(weights)):
        hx, hy, hz = half_vectors[0, s], half_vectors[1, s], half_vectors[2, s]
        along = x * hx + y * hy + z * hz
        ix, iy, iz = two * along * hx - x, two * along * hy - y, two * along * hz - z
        is_above = (along > zero) & (iz > zero)
        weight = along * hz * hz * hz * np.sqrt(max(iz, zero) * inverse)
        weights[s] = weight if is_above else zero
        wx = axes[0, 0] * ix + axes[1, 0] * iy + axes[2, 0] * iz
        wy = axes[0, 1] * ix + axes[1, 1] * iy + axes[2, 1] * iz
        wz = axes[0, 2] * ix + axes[1, 2] * iy + axes[2, 2] * iz
        scale = one / (abs(wx) + abs(wy) + abs(wz))
        u, v = wx * scale, wy * scale
        folded_u = (one - abs(v)) * (one if u >= zero else -one)
        folded_v = (one - abs(u)) * (one if v >= zero else -one)
        u, v = (folded_u if wz < zero else u), (folded_v if wz < zero else v)
        column = min(np.int32((u + one) * scale_of_map), last)
        row = min(np.int32((v + one) * scale_of_map), last)
        texels[s] = row * np.int32(size) + column
