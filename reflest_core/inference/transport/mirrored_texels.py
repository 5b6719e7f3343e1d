# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where a Ward lobe looks for its light: the texels that stratified half vectors mirror."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, vectorised

Vector = tuple[float, float, float]


@compiled
def vector(vectors: NDArray[np.float32], row: int) -> Vector:
    """Read one row.

    Args:
        vectors: (N, 3).
        row: which one.
    """
    return float(vectors[row, 0]), float(vectors[row, 1]), float(vectors[row, 2])


@vectorised
def mirrored_texels(
    frame: tuple[float, ...],
    normal: Vector,
    towards_camera: Vector,
    half_vectors: NDArray[np.float32],
    size: int,
    weights: NDArray[np.float64],
    texels: NDArray[np.int32],
) -> None:
    """Find for each half vector its sample's weight and the texel that its light comes from.

    Args:
        frame: tangent and bitangent, six numbers.
        normal: unit.
        towards_camera: ``omega_o``, unit.
        half_vectors: (3, S) unit, in the tangent frame with +z on the normal.
        size: edge of the octahedral map.
        weights: (S,) takes ``(omega_o . h) cos^3 theta_h sqrt(cos theta_i / cos theta_o)``, 0 below
            the surface.
        texels: (S,) takes indices into the flat map (:func:`.octahedral_texel` without branches, so
            that vector instructions apply).
    """
    tx, ty, tz, bx, by, bz = frame
    nx, ny, nz = normal
    ox, oy, oz = towards_camera
    cosine_o = max(ox * nx + oy * ny + oz * nz, 1e-3)
    for sample in range(len(weights)):
        x, y, z = half_vectors[0, sample], half_vectors[1, sample], half_vectors[2, sample]
        hx = tx * x + bx * y + nx * z
        hy = ty * x + by * y + ny * z
        hz = tz * x + bz * y + nz * z
        along = ox * hx + oy * hy + oz * hz
        cosine_i = 2.0 * along * z - cosine_o
        is_above = (along > 0.0) & (cosine_i > 0.0)
        weight = along * z * z * z * math.sqrt(max(cosine_i, 0.0) / cosine_o)
        weights[sample] = weight if is_above else 0.0
        ix, iy, iz = 2.0 * along * hx - ox, 2.0 * along * hy - oy, 2.0 * along * hz - oz
        scale = 1.0 / (abs(ix) + abs(iy) + abs(iz))
        u, v = ix * scale, iy * scale
        folded_u = (1.0 - abs(v)) * (1.0 if u >= 0.0 else -1.0)
        folded_v = (1.0 - abs(u)) * (1.0 if v >= 0.0 else -1.0)
        u, v = (folded_u if iz < 0.0 else u), (folded_v if iz < 0.0 else v)
        column = min(int((u + 1.0) * 0.5 * size), size - 1)
        row = min(int((v + 1.0) * 0.5 * size), size - 1)
        texels[sample] = row * size + column
