# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The unknown light in patches: what each would add to a reflection."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.transport.light_patches import PatchResponse
from reflest_core.inference.transport.mirrored_texels import fill_axes, texels_of_lobes
from reflest_core.inference.transport.patch_grid import PATCHES, patches_of_texels
from reflest_core.inference.transport.visibility import Sight
from reflest_core.inference.transport.ward_lobe import HALF_VECTORS, LEVELS
from reflest_core.jit import fused, kernel_array
from reflest_core.light.completion import CLIPPED, SEEN, LightPyramid, halved_to


@dataclass(frozen=True)
class Reflection:
    """How R observations respond to each part of the light: a lobe sees few of the P patches.

    Attributes:
        known: (3, R) float32 radiance of light that was seen, of each channel.
        starts: (R + 1,) observation r has the entries ``starts[r]:starts[r + 1]``.
        columns: (E,) of :attr:`.PatchResponse.answers`, from 1, that each entry belongs to.
        values: (3, E) float32 what the entry adds in each channel.
    """

    known: NDArray[np.float32]
    starts: NDArray[np.int64]
    columns: NDArray[np.int32]
    values: NDArray[np.float32]

    @property
    def dense(self) -> PatchResponse:
        """The same with all the answers that are 0."""
        answers = np.zeros((*self.known.shape, 1 + 2 * PATCHES), np.float32)
        answers[..., 0] = self.known
        rows = np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))
        answers[:, rows, self.columns] = self.values
        return PatchResponse(answers)


def reflection(
    filled: LightPyramid,
    roughness: int,
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    sight: Sight | None = None,
) -> Reflection:
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
    return Reflection(
        *_gather(
            level.reshape(-1, 5),
            excess.reshape(-1, 3),
            patches_of_texels(len(level)),
            HALF_VECTORS[roughness],
            kernel_array(normals, np.float32),
            kernel_array(directions, np.float32),
            sight.rows,
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
        answers[:, rows] = part.dense.answers
    return PatchResponse(answers)


@fused
def _gather(
    light: NDArray[np.float32],
    beyond_white: NDArray[np.float32],
    patch_of: NDArray[np.int64],
    half_vectors: NDArray[np.float32],
    normals: NDArray[np.float32],
    directions: NDArray[np.float32],
    sight_of: NDArray[np.int64],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.int32], NDArray[np.float32]]:
    """Sum the samples of each lobe, as a :class:`Reflection` has them.

    ``sight_of`` (O,): rows of ``visible`` (R, P) and of ``own`` (1 or R, P, 3).
    """
    samples, patches, observations = half_vectors.shape[1], visible.shape[1], len(normals)
    seen, starts = np.empty((3, observations), np.float32), np.zeros(observations + 1, np.int64)
    most = 2 * samples * observations
    columns, values = np.empty(most, np.int32), np.empty((most, 3), np.float32)
    weights, texels = np.empty(samples, np.float32), np.empty(samples, np.int32)
    sizes = np.full(samples, int(math.sqrt(len(light))), np.int32)
    firsts, axes = np.zeros(samples, np.int32), np.empty((3, 3), np.float32)
    entry_of, known, entries = np.full(1 + 2 * patches, -1, np.int64), np.zeros(3), 0
    for observation in range(observations):
        fill_axes(normals[observation], axes)
        row = sight_of[observation]
        hiding = row if len(own) > 1 else 0
        texels_of_lobes(axes, directions[observation], half_vectors, sizes, firsts, weights, texels)
        known[:] = 0.0
        for sample in range(samples):
            texel = texels[sample]
            patch = patch_of[texel]
            share = weights[sample] / samples
            arriving = share * visible[row, patch]
            unknown = arriving * (1.0 - light[texel, SEEN])
            for channel in range(3):
                radiance = light[texel, channel]
                known[channel] += (arriving - unknown) * radiance
                known[channel] += (share - arriving) * own[hiding, patch, channel]
            for column in (1 + patch, 1 + patches + patch):
                is_unseen = column <= patches
                if (unknown if is_unseen else light[texel, CLIPPED]) <= 0.0:
                    continue
                if entry_of[column] < 0:
                    entry_of[column], columns[entries], values[entries] = entries, column, 0.0
                    entries += 1
                value = values[entry_of[column]]
                for channel in range(3):
                    of_light = unknown * light[texel, channel]
                    beyond = arriving * beyond_white[texel, channel]
                    value[channel] += of_light if is_unseen else beyond
        for channel in range(3):
            seen[channel, observation] = known[channel]
        starts[observation + 1] = entries
        entry_of[columns[starts[observation] : entries]] = -1
    return seen, starts, columns[:entries].copy(), values[:entries].T.copy()
