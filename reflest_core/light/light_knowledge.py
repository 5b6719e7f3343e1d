# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How much is known of the light that falls on a surface."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import luminance
from reflest_core.light.light_map import ObservedLight
from reflest_core.light.octahedral import octahedral_directions, octahedral_solid_angles

BLOCK = 4
"""Texels along the edge of those that are taken together: a cosine needs no more detail."""


@dataclass(frozen=True)
class LightKnowledge:
    """What is known of the light on a surface: shares in [0, 1], means over voxels.

    Attributes:
        seen: Share of the directions from which light falls on a voxel, weighted by cosine, that
            the background showed.
        clipped: Share of the light seen to come from there that overexposed pixels showed, which is
            in truth stronger.
    """

    seen: float
    clipped: float


UNKNOWN_LIGHT = LightKnowledge(0.0, 0.0)


def light_knowledge(light: ObservedLight | None, normals: NDArray[np.float32]) -> LightKnowledge:
    """Measure what is known of the light on a surface.

    Args:
        light: What was seen; None where it was not gathered.
        normals: (V, 3) unit normals of voxels, world frame.

    Returns:
        The shares.
    """
    if light is None:
        return UNKNOWN_LIGHT
    size = len(light.coverage)
    power = luminance(light.radiance) * light.coverage
    of_texels = np.stack([np.ones_like(power), light.coverage, power, power * light.any_clipped])
    of_texels *= octahedral_solid_angles(size)
    edge = size // BLOCK
    in_block = np.repeat(np.eye(edge, dtype=of_texels.dtype), BLOCK, axis=0)  # sums as products
    of_blocks = (in_block.T @ (of_texels @ in_block)).reshape(4, -1).T
    cosines = np.maximum(normals @ _block_directions(edge).T, 0.0).mean(axis=0)
    whole, seen, received, clipped = (cosines @ of_blocks).tolist()
    return LightKnowledge(seen / whole, clipped / received if received > 0.0 else 0.0)


@cache
def _block_directions(edge: int) -> NDArray[np.float32]:
    return octahedral_directions(edge).reshape(-1, 3)
