# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light in rings of elevation, which do not change when the scene turns about the vertical."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.light.completion import LightPyramid
from reflest_core.light.octahedral import octahedral_directions, octahedral_solid_angles

ZONES = 8
"""Rings of equal height in polar angle, from the zenith down."""
SIZE = 48
"""Edge of the pyramid's level that is summed."""


def light_zones(light: LightPyramid) -> NDArray[np.float32]:
    """Average the light over each ring.

    Args:
        light: The completed light.

    Returns:
        (8, 5) float32: mean completed linear radiance (3), seen share and clipped share.
    """
    level = next(level for level in light.levels if len(level) == SIZE)
    return np.asarray(_weights() @ level.reshape(-1, 5), np.float32)


@cache
def _weights() -> NDArray[np.float32]:
    """(8, SIZE * SIZE): share of each texel in each ring's solid angle."""
    polar = np.arccos(np.clip(octahedral_directions(SIZE)[..., 2].ravel(), -1.0, 1.0))
    zone = np.minimum((polar / np.pi * ZONES).astype(np.int64), ZONES - 1)
    weights = np.zeros((ZONES, SIZE * SIZE), np.float32)
    weights[zone, np.arange(SIZE * SIZE)] = octahedral_solid_angles(SIZE).ravel()
    return np.asarray(weights / weights.sum(axis=1, keepdims=True), np.float32)
