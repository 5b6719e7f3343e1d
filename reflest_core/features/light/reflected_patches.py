# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The unknown light in patches: what each would add to a reflection."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.completion import LightPyramid
from reflest_core.features.light.light_patches import EDGE, PatchResponse
from reflest_core.features.light.mirrored_texels import mirrored_texels, vector
from reflest_core.features.light.ward_lobe import HALF_VECTORS, LEVELS
from reflest_core.features.tangent_frame import tangent_frame
from reflest_core.jit import compiled, kernel_array


def reflection(
    filled: LightPyramid,
    roughness: int,
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
) -> PatchResponse:
    """Lobes of ``ROUGHNESSES[roughness]`` about ``normals``, seen from ``directions``, (O, 3) unit.

    ``filled``: the light after pull and push.
    """
    return PatchResponse(
        *_gather(
            filled.levels[LEVELS[roughness]], HALF_VECTORS[roughness],
            kernel_array(normals, np.float32), kernel_array(directions, np.float32), EDGE,
        )
    )  # fmt: skip


@compiled
def _gather(
    light: NDArray[np.float32],
    half_vectors: NDArray[np.float32],
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    edge: int,
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    size, samples, patches = len(light), half_vectors.shape[1], edge * edge
    seen = np.zeros((len(normals), 3), np.float32)
    unseen = np.zeros((len(normals), patches, 3), np.float32)
    excess = np.zeros((len(normals), patches), np.float32)
    weights, texels = np.empty(samples, np.float64), np.empty(samples, np.int32)
    for observation in range(len(normals)):
        frame = tangent_frame(normals[observation])
        n, o = vector(normals, observation), vector(directions, observation)
        mirrored_texels(frame, n, o, half_vectors, size, weights, texels)
        for sample in range(samples):
            share = weights[sample] / samples
            row, column = texels[sample] // size, texels[sample] % size
            patch = (row * edge // size) * edge + column * edge // size
            hidden = share * (1.0 - light[row, column, 3])
            for channel in range(3):
                radiance = light[row, column, channel]
                unseen[observation, patch, channel] += hidden * radiance
                seen[observation, channel] += (share - hidden) * radiance
            excess[observation, patch] += share * light[row, column, 4]
    return seen, unseen, excess
