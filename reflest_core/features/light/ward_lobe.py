# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light that a Ward lobe gathers, for several roughnesses (Ward 1992, Eq. 7 and 8)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.completion import LightPyramid
from reflest_core.features.light.mirrored_texels import mirrored_texels, vector
from reflest_core.features.tangent_frame import tangent_frame
from reflest_core.jit import compiled

ROUGHNESSES = (0.01, 0.03, 0.06, 0.09, 0.12, 0.15, 0.18, 0.21)
"""Of SynBRDF's materials, evenly; alpha, dimensionless."""
LEVELS = (0, 0, 1, 1, 1, 2, 2, 2)
"""Of the light's pyramid for each roughness: texels narrower than its lobe."""
RINGS, SECTORS = 5, 4


def lobe_radiance(
    light: LightPyramid, normals: NDArray[np.float32], directions: NDArray[np.float32]
) -> NDArray[np.float32]:
    """(O, K, 5) for every observation and every one of K roughnesses.

    ``normals`` and ``directions`` (towards the camera): (O, 3) unit. The first three are the
    radiance reflected at ``rho_s = 1``; then the seen and the clipped share of the lobe.
    Half vectors are stratified over the lobe, ``tan theta_h = alpha sqrt(-ln(1 - u))``, and weigh
    ``(omega_o . h) cos^3 theta_h sqrt(cos theta_i / cos theta_o)``, which is f / pdf for Eq. 1.
    """
    fine, middle, coarse = (level.reshape(-1, 5) for level in light.levels[:3])
    return _gather(
        fine, middle, coarse, np.array(LEVELS), HALF_VECTORS,
        np.ascontiguousarray(normals, np.float32), np.ascontiguousarray(directions, np.float32),
    )  # fmt: skip


def half_vectors() -> NDArray[np.float32]:
    """(K, 3, 20) unit, in the tangent frame with +z on the normal."""
    ring, sector = np.meshgrid(np.arange(RINGS), np.arange(SECTORS), indexing="ij")
    turn = (2.0 * math.pi * (sector + 0.6 * ring) / SECTORS).ravel()
    slope = np.sqrt(-np.log(1.0 - (ring.ravel() + 0.5) / RINGS))
    polar = np.arctan(np.array(ROUGHNESSES)[:, None] * slope)
    return np.stack(
        [np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=1
    ).astype(np.float32)


HALF_VECTORS = half_vectors()


@compiled
def _gather(
    fine: NDArray[np.float32],
    middle: NDArray[np.float32],
    coarse: NDArray[np.float32],
    levels: NDArray[np.int64],
    half_vectors: NDArray[np.float32],
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
) -> NDArray[np.float32]:
    roughnesses, _, samples = half_vectors.shape
    finest = int(math.sqrt(len(fine)))
    gathered = np.empty((len(normals), roughnesses, 5), np.float32)
    weights, texels = np.empty(samples, np.float64), np.empty(samples, np.int32)
    for observation in range(len(normals)):
        frame = tangent_frame(normals[observation])
        n, o = vector(normals, observation), vector(directions, observation)
        for roughness in range(roughnesses):
            level = levels[roughness]
            light = fine if level == 0 else (middle if level == 1 else coarse)
            size = finest >> level
            mirrored_texels(frame, n, o, half_vectors[roughness], size, weights, texels)
            total, red, green, blue, seen, clipped = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for sample in range(samples):
                weight, texel = weights[sample], texels[sample]
                total += weight
                red += weight * light[texel, 0]
                green += weight * light[texel, 1]
                blue += weight * light[texel, 2]
                seen += weight * light[texel, 3]
                clipped += weight * light[texel, 4]
            gathered[observation, roughness, 0] = red / samples
            gathered[observation, roughness, 1] = green / samples
            gathered[observation, roughness, 2] = blue / samples
            gathered[observation, roughness, 3] = seen / max(total, 1e-6)
            gathered[observation, roughness, 4] = clipped / max(total, 1e-6)
    return gathered
