# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light that a Ward lobe gathers, for several roughnesses (Ward 1992, Eq. 7 and 8)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.transport.mirrored_texels import mirrored_texels, vector
from reflest_core.inference.transport.patch_grid import patches_of_texels
from reflest_core.inference.transport.visibility import Sight
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.completion import LightPyramid
from reflest_core.surface.tangent_frame import tangent_frame

ROUGHNESSES = (0.01, 0.03, 0.06, 0.09, 0.12, 0.15, 0.18, 0.21)
"""Of SynBRDF's materials, evenly; alpha, dimensionless."""
LEVELS = (0, 0, 1, 1, 1, 2, 2, 2)
"""Of the light's pyramid for each roughness: texels narrower than its lobe."""
RINGS, SECTORS = 5, 4

_Levels = tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]
"""Of a :class:`LightPyramid`, the finest three, (N * N, 5) and so on."""
_PatchesOfLevels = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]
"""The patch of each of their texels."""


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
    if sight.is_coloured:
        lobes = [
            _coloured_lobe(
                _flat(light.levels[level]),
                _patches(light.levels[level]),
                half,
                kernel_array(normals, np.float32),
                kernel_array(directions, np.float32),
                kernel_array(sight.visible, np.float32),
                kernel_array(sight.own, np.float32),
            )
            for level, half in zip(LEVELS, HALF_VECTORS, strict=True)
        ]
        return np.stack(lobes, axis=1)
    fine, middle, coarse = light.levels[:3]
    return _gather(
        (_flat(fine), _flat(middle), _flat(coarse)),
        (_patches(fine), _patches(middle), _patches(coarse)),
        np.array(LEVELS),
        HALF_VECTORS,
        kernel_array(normals, np.float32),
        kernel_array(directions, np.float32),
        kernel_array(sight.visible, np.float32),
        kernel_array(sight.own, np.float32),
    )


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
    sight = Sight.open(len(normals))
    gathered = _gather(
        (_flat(level),) * 3,
        (_patches(level),) * 3,
        np.array([0]),
        half,
        kernel_array(normals, np.float32),
        kernel_array(directions, np.float32),
        sight.visible,
        sight.own,
    )
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


def _patches(level: NDArray[np.float32]) -> NDArray[np.int64]:
    return patches_of_texels(len(level))


@compiled
def _gather(
    lights: _Levels,
    patches: _PatchesOfLevels,
    level_of: NDArray[np.int64],
    half_vectors: NDArray[np.float32],
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
) -> NDArray[np.float32]:
    roughnesses, _, samples = half_vectors.shape
    gathered = np.empty((len(normals), roughnesses, 5), np.float32)
    weights, texels = np.empty(samples, np.float64), np.empty(samples, np.int32)
    for observation in range(len(normals)):
        frame = tangent_frame(normals[observation])
        n, o = vector(normals, observation), vector(directions, observation)
        for roughness in range(roughnesses):
            light, patch_of = lights[level_of[roughness]], patches[level_of[roughness]]
            size = int(math.sqrt(len(light)))
            mirrored_texels(frame, n, o, half_vectors[roughness], size, weights, texels)
            total, red, green, blue, seen, clipped = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            itself = 0.0
            for sample in range(samples):
                texel = texels[sample]
                weight = weights[sample] * visible[observation, patch_of[texel]]
                total += weights[sample]
                itself += weights[sample] - weight
                red += weight * light[texel, 0]
                green += weight * light[texel, 1]
                blue += weight * light[texel, 2]
                seen += weight * light[texel, 3]
                clipped += weight * light[texel, 4]
            gathered[observation, roughness, 0] = (red + itself * own[0]) / samples
            gathered[observation, roughness, 1] = (green + itself * own[1]) / samples
            gathered[observation, roughness, 2] = (blue + itself * own[2]) / samples
            gathered[observation, roughness, 3] = seen / max(total, 1e-6)
            gathered[observation, roughness, 4] = clipped / max(total, 1e-6)
    return gathered


@compiled
def _coloured_lobe(
    light: NDArray[np.float32],
    patch_of: NDArray[np.int64],
    half_vectors: NDArray[np.float32],
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
) -> NDArray[np.float32]:
    size, samples = int(math.sqrt(len(light))), half_vectors.shape[1]
    gathered = np.zeros((len(normals), 5), np.float32)
    weights, texels = np.empty(samples, np.float64), np.empty(samples, np.int32)
    for observation in range(len(normals)):
        frame = tangent_frame(normals[observation])
        n, o = vector(normals, observation), vector(directions, observation)
        mirrored_texels(frame, n, o, half_vectors, size, weights, texels)
        total, known, clipped = 0.0, 0.0, 0.0
        for sample in range(samples):
            texel = texels[sample]
            patch = patch_of[texel]
            weight = weights[sample] * visible[observation, patch]
            hidden = weights[sample] - weight
            total += weights[sample]
            known += weight * light[texel, 3] + hidden
            clipped += weight * light[texel, 4]
            for channel in range(3):
                sent = weight * light[texel, channel] + hidden * own[observation, patch, channel]
                gathered[observation, channel] += sent / samples
        gathered[observation, 3] = known / max(total, 1e-6)
        gathered[observation, 4] = clipped / max(total, 1e-6)
    return gathered
