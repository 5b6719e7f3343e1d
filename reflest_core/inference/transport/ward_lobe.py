# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light that a Ward lobe gathers, for several roughnesses (Ward 1992, Eq. 7 and 8)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.transport.mirrored_texels import fill_axes, texels_of_lobes
from reflest_core.inference.transport.patch_grid import patches_of_texels
from reflest_core.inference.transport.visibility import Sight
from reflest_core.jit import fused, kernel_array
from reflest_core.light.completion import LightPyramid

ROUGHNESSES = (0.01, 0.03, 0.06, 0.09, 0.12, 0.15, 0.18, 0.21)
"""Of SynBRDF's materials, evenly; alpha, dimensionless."""
LEVELS = (0, 0, 1, 1, 1, 2, 2, 2)
"""Of the light's pyramid for each roughness: texels narrower than its lobe."""
RINGS, SECTORS = 5, 4


def lobe_radiance(
    light: LightPyramid,
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    sight: Sight | None = None,
) -> NDArray[np.float32]:
    """Gather the light in the Ward lobe of each observation, for each of K roughnesses.

    Half vectors are stratified over the lobe, ``tan theta_h = alpha sqrt(-ln(1 - u))``, and weigh
    ``(omega_o . h) cos^3 theta_h sqrt(cos theta_i / cos theta_o)``, which is f / pdf for Eq. 1.

    Args:
        light: the light, filled or completed.
        normals: (O, 3) unit.
        directions: (O, 3) unit, towards the camera.
        sight: of the O observations; None where nothing is hidden. What the scene sends itself
            counts as unseen where only its mean colour is known, and as seen where each patch has
            a colour.

    Returns:
        (O, K, 5): radiance reflected at ``rho_s = 1``; then the seen and the saturated share of the
        lobe.
    """
    sight = sight or Sight.open(len(normals))
    levels = [light.levels[level] for level in LEVELS]
    return _gathered(levels, HALF_VECTORS, normals, directions, sight)


def reflected(
    light: LightPyramid,
    alpha: float,
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    rings: int = 8,
    sectors: int = 8,
) -> NDArray[np.float32]:
    """Render a surface with ``rho_d = 0`` and ``rho_s = 1``.

    As :func:`lobe_radiance`, from more half vectors and at the resolution that their spacing needs.

    Args:
        light: the light.
        alpha: roughness.
        normals: (O, 3) unit.
        directions: (O, 3) unit, towards the camera.
        rings: strata of the half vectors' polar angle.
        sectors: strata of their azimuth.

    Returns:
        (O, 3) linear radiance.
    """
    half = half_vectors((alpha,), rings, sectors)
    spacing = 4.0 * alpha / math.sqrt(rings * sectors)
    texel = math.sqrt(4.0 * math.pi) / len(light.levels[0])
    coarseness = int(np.clip(math.log2(max(spacing / texel, 1.0)), 0, 2))
    level = light.levels[coarseness]
    gathered = _gathered([level], half, normals, directions, Sight.open(len(normals)))
    return gathered[:, 0, :3]


def half_vectors(
    alphas: Sequence[float], rings: int = RINGS, sectors: int = SECTORS
) -> NDArray[np.float32]:
    """Stratify half vectors over lobes.

    Args:
        alphas: K roughnesses.
        rings: strata of the polar angle.
        sectors: strata of the azimuth.

    Returns:
        (K, 3, S) unit, in the tangent frame with +z on the normal; S = rings * sectors.
    """
    ring, sector = np.meshgrid(np.arange(rings), np.arange(sectors), indexing="ij")
    turn = (2.0 * math.pi * (sector + 0.6 * ring) / sectors).ravel()
    slope = np.sqrt(-np.log(1.0 - (ring.ravel() + 0.5) / rings))
    polar = np.arctan(np.array(alphas)[:, None] * slope)
    return np.stack(
        [np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=1
    ).astype(np.float32)


HALF_VECTORS = half_vectors(ROUGHNESSES)


def _flat(level: NDArray[np.float32]) -> NDArray[np.float32]:
    return level.reshape(-1, 5)


def _patches(level: NDArray[np.float32]) -> NDArray[np.uint8]:
    return patches_of_texels(len(level)).astype(np.uint8)  # small, to stay in the fastest cache


def _gathered(
    levels: Sequence[NDArray[np.float32]],
    half: NDArray[np.float32],
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    sight: Sight,
) -> NDArray[np.float32]:
    """Gather lobes (K, 3, S) of half vectors, each from its map (N, N, 5) of ``levels``."""
    samples, sizes = half.shape[2], [len(level) for level in levels]
    maps = dict(zip(sizes, levels, strict=True))
    first_of, first = {}, 0
    for size in maps:
        first_of[size] = first
        first += size * size
    gather = _gather_coloured if sight.is_coloured else _gather
    return gather(
        np.concatenate([_flat(level) for level in maps.values()]),
        np.concatenate([_patches(level) for level in maps.values()]),
        np.repeat(np.array([first_of[size] for size in sizes], np.int32), samples),
        np.repeat(np.array(sizes, np.int32), samples),
        kernel_array(half.transpose(1, 0, 2).reshape(3, -1), np.float32),
        samples,
        kernel_array(normals, np.float32),
        kernel_array(directions, np.float32),
        sight.rows,
        kernel_array(sight.visible, np.float32),
        kernel_array(sight.own, np.float32),
    )


@fused
def _gather(
    lights: NDArray[np.float32],
    patch_of: NDArray[np.uint8],
    firsts: NDArray[np.int32],
    sizes: NDArray[np.int32],
    half_vectors: NDArray[np.float32],
    samples: int,
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    sight_of: NDArray[np.int64],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Sum the samples of each lobe, ``samples`` of ``half_vectors`` (3, K * S) to each.

    ``sight_of`` (O,): rows of ``visible`` (R, P).
    """
    roughnesses = len(sizes) // samples
    gathered = np.empty((len(normals), roughnesses, 5), np.float32)
    weights, texels = np.empty(len(sizes), np.float32), np.empty(len(sizes), np.int32)
    axes = np.empty((3, 3), np.float32)
    for observation in range(len(normals)):
        fill_axes(normals[observation], axes)
        texels_of_lobes(axes, directions[observation], half_vectors, sizes, firsts, weights, texels)
        arrives = visible[sight_of[observation]]
        for roughness in range(roughnesses):
            none = np.float32(0.0)
            total, red, green, blue, seen, clipped = none, none, none, none, none, none
            arriving = none
            for sample in range(roughness * samples, (roughness + 1) * samples):
                texel = texels[sample]
                weight = weights[sample] * arrives[patch_of[texel]]
                total += weights[sample]
                arriving += weight
                red += weight * lights[texel, 0]
                green += weight * lights[texel, 1]
                blue += weight * lights[texel, 2]
                seen += weight * lights[texel, 3]
                clipped += weight * lights[texel, 4]
            itself, place = total - arriving, gathered[observation, roughness]
            place[0] = (red + itself * own[0]) / samples
            place[1] = (green + itself * own[1]) / samples
            place[2] = (blue + itself * own[2]) / samples
            place[3] = seen / max(total, np.float32(1e-6))
            place[4] = clipped / max(total, np.float32(1e-6))
    return gathered


@fused
def _gather_coloured(
    lights: NDArray[np.float32],
    patch_of: NDArray[np.uint8],
    firsts: NDArray[np.int32],
    sizes: NDArray[np.int32],
    half_vectors: NDArray[np.float32],
    samples: int,
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    sight_of: NDArray[np.int64],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Do as :func:`_gather` where what hides patches is seen, in the colours ``own`` (R, P, 3)."""
    roughnesses = len(sizes) // samples
    gathered = np.empty((len(normals), roughnesses, 5), np.float32)
    weights, texels = np.empty(len(sizes), np.float32), np.empty(len(sizes), np.int32)
    axes = np.empty((3, 3), np.float32)
    for observation in range(len(normals)):
        fill_axes(normals[observation], axes)
        texels_of_lobes(axes, directions[observation], half_vectors, sizes, firsts, weights, texels)
        arrives, colours = visible[sight_of[observation]], own[sight_of[observation]]
        for roughness in range(roughnesses):
            none = np.float32(0.0)
            total, red, green, blue, known, clipped = none, none, none, none, none, none
            for sample in range(roughness * samples, (roughness + 1) * samples):
                texel = texels[sample]
                patch = patch_of[texel]
                weight = weights[sample] * arrives[patch]
                hidden = weights[sample] - weight
                total += weights[sample]
                red += weight * lights[texel, 0] + hidden * colours[patch, 0]
                green += weight * lights[texel, 1] + hidden * colours[patch, 1]
                blue += weight * lights[texel, 2] + hidden * colours[patch, 2]
                known += weight * lights[texel, 3] + hidden
                clipped += weight * lights[texel, 4]
            place = gathered[observation, roughness]
            place[0], place[1], place[2] = red / samples, green / samples, blue / samples
            place[3] = known / max(total, np.float32(1e-6))
            place[4] = clipped / max(total, np.float32(1e-6))
    return gathered
