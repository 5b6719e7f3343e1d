# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The unknown light in patches: what each would add to what a surface sends back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.completion import LightPyramid, halved_to
from reflest_core.features.light.cosine_weights import SIZE
from reflest_core.features.light.irradiance import Incoming
from reflest_core.features.light.patch_grid import texels_of_patches
from reflest_core.fusion.light_map import ObservedLight


@dataclass(frozen=True)
class PatchResponse:
    """Radiance of R answers to the light, in parts that add up; P patches.

    Answers are ``E(n) / pi`` of normals, or observations of a surface that only shines with
    ``rho_s = 1``. ``seen``: (R, 3), to the light as it was seen, clipped pixels as white.
    ``unseen``: (R, P, 3), to a smooth fill of each patch's unseen directions. ``excess``: (R, P,
    3), to radiance 1 above white where each patch was seen clipped in all channels, and as much
    less in the others as :func:`.excess_shape` expects. All float32.
    """

    seen: NDArray[np.float32]
    unseen: NDArray[np.float32]
    excess: NDArray[np.float32]

    def columns(self, rows: NDArray[Any] | slice, channel: int) -> NDArray[np.float32]:
        """The chosen answers, (S, 1 + 2 P), to what was seen and to every patch."""
        # Of one channel first: rows that lie together are copied many times faster.
        of_channel = np.concatenate(
            [
                self.seen[:, channel, None],
                self.unseen[..., channel],
                self.excess[..., channel],
            ],
            axis=1,
        )
        return np.asarray(of_channel[rows])


@dataclass(frozen=True)
class LightParts:
    """The light in T = SIZE^2 texels, as coarse as diffuse surfaces need it; (T, 3) float32.

    ``seen``: as it was seen. ``fill``: what a smooth fill adds where it was not. ``excess``: see
    :func:`.excess_shape`.
    """

    seen: NDArray[np.float32]
    fill: NDArray[np.float32]
    excess: NDArray[np.float32]

    @staticmethod
    def of(light: ObservedLight, filled: LightPyramid) -> LightParts:
        """``filled``: the same light after pull and push."""
        seen = light.radiance * light.coverage[..., None]
        both = halved_to(np.concatenate([seen, filled.excess], axis=-1), SIZE)
        level = next(level for level in filled.levels if len(level) == SIZE)
        seen, excess, whole = (
            part.reshape(-1, 3) for part in (both[..., :3], both[..., 3:], level[..., :3])
        )
        return LightParts(seen, np.maximum(whole - seen, 0.0), excess)


def diffuse_response(light: LightParts, incoming: Incoming) -> PatchResponse:
    """How a matte white surface would answer to each part of the light.

    What comes from the surface itself counts as seen.
    """
    by_patch = incoming.weights[:, texels_of_patches(SIZE)]
    unknown = _summed(by_patch, np.concatenate([light.fill, light.excess], axis=-1))
    return PatchResponse(
        seen=np.asarray(incoming.weights @ light.seen + incoming.own, np.float32),
        unseen=unknown[..., :3],
        excess=unknown[..., 3:],
    )


def _summed(by_patch: NDArray[np.float32], texels: NDArray[np.float32]) -> NDArray[np.float32]:
    """(V, P, T) weights and (SIZE * SIZE, C) values to (V, P, C)."""
    values = texels[texels_of_patches(SIZE)]
    return np.asarray((by_patch.transpose(1, 0, 2) @ values).transpose(1, 0, 2), np.float32)
