# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Diffuse light on a surface of any normal, and how much of its origin was seen."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.completion import LightPyramid
from reflest_core.fusion.octahedral import octahedral_directions, octahedral_solid_angles

DARKEST = 1e-4
"""``E(n) / pi`` that a ratio is taken to at least, in units of the sensor's white."""
SIZE = 24
"""Edge of the pyramid's level that is summed: 8 degrees a texel, plenty for a cosine."""


def mean_radiance(light: LightPyramid, normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """(V, 5) for unit ``normals`` (V, 3): cosine-weighted means over the hemisphere.

    The first three are ``E(n) / pi``, the radiance that a white Lambertian surface would send back;
    then the seen share and the clipped share of the light that falls on it. No visibility: the
    surface itself hides nothing.
    """
    return weighted_radiance(light, cosine_weights(normals))


def weighted_radiance(light: LightPyramid, weights: NDArray[np.float32]) -> NDArray[np.float32]:
    """The same for normals whose :func:`cosine_weights` are known, (V, SIZE * SIZE)."""
    level = next(level for level in light.levels if len(level) == SIZE)
    return np.asarray(weights @ level.reshape(-1, 5), np.float32)


def cosine_weights(normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """(V, SIZE * SIZE): share of each texel's radiance in ``E(n) / pi``; each row sums to 1."""
    directions, angles = _sphere()
    weights = np.maximum(normals @ directions.T, 0.0) * angles
    return np.asarray(weights / weights.sum(axis=1, keepdims=True), np.float32)


@cache
def _sphere() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    return octahedral_directions(SIZE).reshape(-1, 3), octahedral_solid_angles(SIZE).reshape(-1)
