# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light that a scan saw behind the object, completed, as an equirectangular map."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.environment.completed_light import completed_light
from reflest_core.light.completion import CLIPPED, RADIANCE, SEEN
from reflest_core.light.equirectangular import equirectangular_directions
from reflest_core.light.octahedral import octahedral_texels
from reflest_core.surface.observed_surface import ObservedSurface

HEIGHT = 128
"""Rows by default: 1.4 degrees each, finer than a texel of the light map."""
SAMPLES = 3
"""Looked up along each edge of a pixel and averaged."""


@dataclass(frozen=True)
class EnvironmentMap:
    """The light around a scan, world frame (:mod:`reflest_core.light.equirectangular`).

    Attributes:
        radiance: (H, 2 H, 3) float32, linear sRGB, 1 at the sensor's white in the first frame:
            relative, for nobody knows the exposure. As seen where it was seen, elsewhere completed
            (:func:`.completed_light`).
        coverage: (H, 2 H) float32 in [0, 1], the share of the pixel that was seen.
        clipped: (H, 2 H) float32 in [0, 1], the share of what was seen there that passed the
            camera's white, so that it is known only as a lower bound.
    """

    radiance: NDArray[np.float32]
    coverage: NDArray[np.float32]
    clipped: NDArray[np.float32]


def environment_map(surface: ObservedSurface, height: int = HEIGHT) -> EnvironmentMap:
    """Return the completed light around a surface.

    Args:
        surface: What was observed.
        height: Rows of the map.

    Returns:
        The map; all zeros where no light was seen at all.
    """
    if surface.light is None or not surface.light.seen_share > 0.0:
        return nothing_seen(height)
    return from_octahedral(completed_light(surface), height)


def from_octahedral(light: NDArray[np.float32], height: int = HEIGHT) -> EnvironmentMap:
    """Resample an octahedral map.

    Args:
        light: (N, N, 5) radiance (3), share seen, share seen clipped.
        height: Rows of the map.

    Returns:
        The equirectangular map.
    """
    looked_up = light.reshape(-1, light.shape[-1])[_texels(height, len(light))].mean(axis=2)
    coverage = looked_up[..., SEEN]
    clipped = looked_up[..., CLIPPED] / np.maximum(coverage, 1e-6)
    return EnvironmentMap(
        np.ascontiguousarray(looked_up[..., RADIANCE]), np.ascontiguousarray(coverage), clipped
    )


def nothing_seen(height: int = HEIGHT) -> EnvironmentMap:
    """Return the map of a scan that saw no light.

    Args:
        height: Rows of the map.

    Returns:
        A black map without coverage.
    """
    black = np.zeros((height, 2 * height, 3), np.float32)
    return EnvironmentMap(black, black[..., 0].copy(), black[..., 0].copy())


@lru_cache(maxsize=2)
def _texels(height: int, size: int) -> NDArray[np.int64]:
    """(height, 2 height, SAMPLES^2) texels of the octahedral map that a pixel's samples lie in."""
    fine = octahedral_texels(equirectangular_directions(height * SAMPLES), size)
    cells = fine.reshape(height, SAMPLES, 2 * height, SAMPLES).swapaxes(1, 2)
    return cells.reshape(height, 2 * height, SAMPLES**2)
