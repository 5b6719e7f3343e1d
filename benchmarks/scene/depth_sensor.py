# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Noise of a structured-light depth sensor.

Its standard deviation grows with the square of the distance: 1.2 mm at 0.4 m, and 1.9 mm more for
each square metre beyond. At grazing angles and in random patches there is no depth.
"""

from __future__ import annotations

import math

import numba
import numpy as np

GRAZING = 0.12
"""Cosine of the angle of incidence below which there is no depth."""
MISSED = 0.003
"""Share of the patches without depth."""
PATCH = 4
"""Edge of a patch, pixels."""


@numba.njit(cache=True, nogil=True, error_model="numpy")
def sensed_depth(z: float, cosine: float, row: int, column: int, number: int) -> int:
    """The sensor's reading.

    Args:
        z: True depth, metres.
        cosine: Of the angle of incidence.
        row: Of the pixel.
        column: Of the pixel.
        number: Of the frame, a seed of the noise.

    Returns:
        Millimetres, 0 for no depth.
    """
    if cosine < GRAZING or _uniform(row // PATCH, column // PATCH, number) < MISSED:
        return 0
    # The sum of two uniform values stands for a normal one.
    even = _uniform(row, column, 2 * number) + _uniform(row, column, 2 * number + 1) - 1.0
    sigma = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4)
    return int((z + sigma * math.sqrt(6.0) * even) * 1000.0 + 0.5)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _uniform(row: int, column: int, seed: int) -> float:
    """A value in [0, 1) hashed from three whole numbers."""
    h = np.uint64(row) * np.uint64(0x9E3779B97F4A7C15)
    h ^= np.uint64(column) * np.uint64(0xD6E8FEB86659FD93)
    h ^= np.uint64(seed) * np.uint64(0xC2B2AE3D27D4EB4F)
    for _ in range(2):
        h ^= h >> np.uint64(32)
        h *= np.uint64(0xBF58476D1CE4E5B9)
    h ^= h >> np.uint64(29)
    return float(h >> np.uint64(11)) / 9007199254740992.0
