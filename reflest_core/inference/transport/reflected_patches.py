# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The unknown light in patches: what each would add to a reflection."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.transport.light_patches import PatchResponse
from reflest_core.inference.transport.mirrored_texels import fill_axes, texels_of_lobes
from reflest_core.inference.transport.patch_grid import PATCHES, patches_of_texels
from reflest_core.inference.transport.visibility import Sight
from reflest_core.inference.transport.ward_lobe import HALF_VECTORS, LEVELS
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.completion import LightPyramid, halved_to


def reflection(
    filled: LightPyramid,
    roughness: int,
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    sight: Sight | None = None,
) -> PatchResponse:
    """Compute how glossy observations respond to each part of the light, at ``rho_s = 1``.

    Args:
        filled: the light, filled smoothly.
        roughness: index into :data:`.ROUGHNESSES`.
        normals: (O, 3) unit.
        directions: (O, 3) unit, towards the camera.
        sight: of the O observations; None where nothing is hidden. What comes from the scene itself
            counts as seen.
    """
    sight = sight or Sight.open(len(normals))
    level = filled.levels[LEVELS[roughness]]
    excess = halved_to(filled.excess, len(level))
    own = sight.own if sight.is_coloured else np.broadcast_to(sight.own, (1, PATCHES, 3))
    return PatchResponse(
        _gather(
            level.reshape(-1, 5),
            excess.reshape(-1, 3),
            patches_of_texels(len(level)),
            HALF_VECTORS[roughness],
            kernel_array(normals, np.float32),
            kernel_array(directions, np.float32),
            kernel_array(sight.visible, np.float32),
            kernel_array(own, np.float32),
        )
    )


def scene_reflection(
    filled: LightPyramid,
    roughness_of: NDArray[np.int64],
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    sight: Sight,
) -> PatchResponse:
    """Compute the same of observations that have a roughness each.

    Args:
        filled: the light, filled smoothly.
        roughness_of: (O,) index into :data:`.ROUGHNESSES` of each observation.
        normals: (O, 3) unit.
        directions: (O, 3) unit, towards the camera.
        sight: of the O observations.
    """
    answers = np.zeros((3, len(normals), 1 + 2 * PATCHES), np.float32)
    for roughness in np.unique(roughness_of):
        rows = np.flatnonzero(roughness_of == roughness)
        part = reflection(filled, int(roughness), normals[rows], directions[rows], sight.of(rows))
        answers[:, rows] = part.answers
    return PatchResponse(answers)


@compiled
def _gather(
    light: NDArray[np.float32],
    beyond_white: NDArray[np.float32],
    patch_of: NDArray[np.int64],
    half_vectors: NDArray[np.float32],
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Sum the samples of each lobe; ``own`` (1 or O, P, 3): of all observations or of each."""
    samples, patches = half_vectors.shape[1], visible.shape[1]
    answers = np.zeros((3, len(normals), 1 + 2 * patches), np.float32)
    weights, texels = np.empty(samples, np.float32), np.empty(samples, np.int32)
    sizes = np.full(samples, int(math.sqrt(len(light))), np.int32)
    firsts, axes = np.zeros(samples, np.int32), np.empty((3, 3), np.float32)
    for observation in range(len(normals)):
        fill_axes(normals[observation], axes)
        hiding = observation if len(own) > 1 else 0
        texels_of_lobes(axes, directions[observation], half_vectors, sizes, firsts, weights, texels)
        for sample in range(samples):
            texel = texels[sample]
            patch = patch_of[texel]
            share = weights[sample] / samples
            arriving = share * visible[observation, patch]
            unknown = arriving * (1.0 - light[texel, 3])
            for channel in range(3):
                radiance = light[texel, channel]
                answer = answers[channel, observation]
                answer[0] += (arriving - unknown) * radiance
                answer[0] += (share - arriving) * own[hiding, patch, channel]
                answer[1 + patch] += unknown * radiance
                answer[1 + patches + patch] += arriving * beyond_white[texel, channel]
    return answers
