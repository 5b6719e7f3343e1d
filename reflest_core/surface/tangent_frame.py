# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The local frame of a voxel: +z on its normal, azimuth origin at the projection of world up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled

_NEARLY_VERTICAL = 1e-6
"""Below this squared length the projection of world up says nothing; world x takes its place."""


@compiled
def tangent_frame(normal: NDArray[np.float32]) -> tuple[float, ...]:
    """Return the tangent and bitangent of a normal; a kernel.

    The tangent is the azimuth origin: the projection of world up, +z; for a vertical normal that of
    world x.

    Args:
        normal: (3,) unit.

    Returns:
        x, y, z of the tangent, then of the bitangent.
    """
    nx, ny, nz = float(normal[0]), float(normal[1]), float(normal[2])
    tx, ty, tz = -nz * nx, -nz * ny, 1.0 - nz * nz
    if tx * tx + ty * ty + tz * tz < _NEARLY_VERTICAL:
        tx, ty, tz = 1.0 - nx * nx, -nx * ny, -nx * nz
    scale = 1.0 / np.sqrt(tx * tx + ty * ty + tz * tz)
    tx, ty, tz = tx * scale, ty * scale, tz * scale
    return tx, ty, tz, ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
