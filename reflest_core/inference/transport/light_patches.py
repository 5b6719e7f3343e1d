# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The unknown light in patches: what each would add to what a surface sends back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.transport.irradiance import Incoming
from reflest_core.inference.transport.patch_grid import PATCHES, patch_image, patches_of_texels
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.completion import RADIANCE, LightPyramid, halved_to, levels_below
from reflest_core.light.cosine_weights import SIZE
from reflest_core.light.light_map import ObservedLight


@dataclass(frozen=True)
class PatchResponse:
    """Radiance of R responses to the light, in parts that add up; P patches.

    Responses are ``E(n) / pi`` of normals, or observations of a surface with ``rho_d = 0`` and
    ``rho_s = 1``.

    Attributes:
        answers: (3, R, 1 + 2 P) float32, of each channel: to the light as it was seen, saturated
            pixels as white; to a smooth fill of each patch's unseen directions; and to radiance 1
            above white where each patch was seen saturated in all channels, and as much less in
            the others as :func:`.excess_shape` expects.
    """

    answers: NDArray[np.float32]

    @property
    def seen(self) -> NDArray[np.float32]:
        """(R, 3), to what was seen."""
        return self.answers[..., 0].T

    @property
    def unseen(self) -> NDArray[np.float32]:
        """(R, P, 3), to the fill of each patch."""
        return self.answers[..., 1 : 1 + PATCHES].transpose(1, 2, 0)

    @property
    def excess(self) -> NDArray[np.float32]:
        """(R, P, 3), to what is above white in each patch."""
        return self.answers[..., 1 + PATCHES :].transpose(1, 2, 0)


@dataclass(frozen=True)
class LightParts:
    """The light in T = SIZE^2 texels, as coarse as diffuse surfaces need it.

    Attributes:
        seen: (T, 3) float32, as it was seen.
        fill: (T, 3) what a smooth fill adds where it was not.
        excess: (T, 3), see :func:`.excess_shape`.
    """

    seen: NDArray[np.float32]
    fill: NDArray[np.float32]
    excess: NDArray[np.float32]

    @staticmethod
    def of(light: ObservedLight, filled: LightPyramid) -> LightParts:
        """Separate what was seen from what was filled.

        Args:
            light: as it was seen.
            filled: the same, filled smoothly.
        """
        seen = light.radiance * light.coverage[..., None]
        both = halved_to(np.concatenate([seen, filled.excess], axis=-1), SIZE)
        level = next(level for level in filled.levels if len(level) == SIZE)
        seen, excess, whole = (
            part.reshape(-1, 3) for part in (both[..., :3], both[..., 3:], level[..., :3])
        )
        return LightParts(seen, np.maximum(whole - seen, 0.0), excess)


def patches_of(values: NDArray[np.floating]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Separate what patches hold of unseen light from what they hold of clipped light.

    Args:
        values: (3, 2 P), of each channel: of the patches' unseen light, then of their excess.

    Returns:
        (P, 3) each, as :func:`completed_light` takes them.
    """
    return values.T[:PATCHES].astype(np.float32), values.T[PATCHES:].astype(np.float32)


def completed_light(
    observed: ObservedLight,
    filled: LightPyramid,
    unseen: NDArray[np.float32],
    excess: NDArray[np.float32],
) -> LightPyramid:
    """Add to the light that was seen what was inferred of its unseen and clipped parts.

    Args:
        observed: the light as it was seen.
        filled: the same, filled smoothly.
        unseen: (P, 3) factor to each patch's fill.
        excess: (P, 3) radiance above white where a patch was clipped.
    """
    fine = filled.levels[0]
    size = len(fine)
    bright = observed.radiance + patch_image(excess, size) * filled.excess
    fill = fine[..., RADIANCE] * patch_image(unseen, size)
    radiance = np.where(observed.coverage[..., None] > 0.0, bright, fill)
    finest = np.concatenate([radiance, fine[..., 3:]], axis=-1).astype(np.float32)
    return levels_below(finest, filled.excess)


def diffuse_response(light: LightParts, incoming: Incoming) -> PatchResponse:
    """Compute how a matte white surface responds to each part of the light.

    Args:
        light: the parts.
        incoming: from where light comes; what comes from the surface itself counts as seen.
    """
    answers = np.zeros((3, len(incoming.weights), 1 + 2 * PATCHES), np.float32)
    answers[..., 0] = (incoming.weights @ light.seen + incoming.own).T
    for first, texels in ((1, light.fill), (1 + PATCHES, light.excess)):
        held = np.flatnonzero(texels.any(axis=1))  # most hold nothing
        columns = first + patches_of_texels(SIZE)[held]
        _add(kernel_array(incoming.weights, np.float32), held, columns, texels[held], answers)
    return PatchResponse(answers)


@compiled
def _add(
    weights: NDArray[np.float32],
    held: NDArray[np.int64],
    columns: NDArray[np.int64],
    values: NDArray[np.float32],
    answers: NDArray[np.float32],
) -> None:
    """Add the ``values`` (N, 3) of N texels to the columns of their patches, for V voxels."""
    for voxel in range(len(weights)):
        for n in range(len(held)):
            weight = weights[voxel, held[n]]
            if weight > 0.0:
                for channel in range(3):
                    answers[channel, voxel, columns[n]] += weight * values[n, channel]
