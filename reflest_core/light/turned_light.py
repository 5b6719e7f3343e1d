# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Rotation of the light map."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, kernel_array
from reflest_core.light.light_map import ObservedLight
from reflest_core.light.octahedral import octahedral_directions, octahedral_texel

ACROSS = 2
"""Each texel takes the mean of as many squared directions within it."""


def turned_light(light: ObservedLight, rotation: NDArray[np.floating]) -> ObservedLight:
    """Rotate what was seen: what came from ``d`` comes from ``rotation @ d`` then.

    A texel that was seen in part is the mean of that part, and its coverage the part's share.

    Args:
        light: What was seen.
        rotation: (3, 3) rotation.

    Returns:
        The rotated map.
    """
    directions = octahedral_directions(ACROSS * len(light.coverage))
    radiance, coverage, clipped = _turn(
        *(
            kernel_array(array, np.float32)
            for array in (light.radiance, light.coverage, light.clipped, directions @ rotation)
        )
    )
    return dataclasses.replace(light, radiance=radiance, coverage=coverage, clipped=clipped)


@compiled
def _turn(
    radiance: NDArray[np.float32],
    coverage: NDArray[np.float32],
    clipped: NDArray[np.float32],
    sources: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """``sources``: (ACROSS N, ACROSS N, 3), where the directions of each texel came from."""
    turned_radiance = np.zeros_like(radiance)
    turned_coverage = np.zeros_like(coverage)
    turned_clipped = np.zeros_like(clipped)
    size = len(coverage)
    for row in range(size):
        for column in range(size):
            total = np.float32(0.0)
            for i in range(ACROSS * ACROSS):
                source = sources[ACROSS * row + i // ACROSS, ACROSS * column + i % ACROSS]
                v, u = octahedral_texel(source[0], source[1], source[2], size)
                weight = coverage[v, u]
                total += weight
                for channel in range(3):
                    turned_clipped[row, column, channel] += weight * clipped[v, u, channel]
                    turned_radiance[row, column, channel] += weight * radiance[v, u, channel]
            if total > 0.0:
                turned_coverage[row, column] = total / (ACROSS * ACROSS)
                for channel in range(3):
                    turned_clipped[row, column, channel] /= total
                    turned_radiance[row, column, channel] /= total
    return turned_radiance, turned_coverage, turned_clipped
