# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where a Ward lobe looks for its light: the texels that stratified half vectors mirror."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, fused, vectorised
from reflest_core.surface.tangent_frame import tangent_frame

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


@compiled
def fill_axes(normal: NDArray[np.float32], axes: NDArray[np.float32]) -> None:
    """Fill in the local frame of a normal.

    Args:
        normal: (3,) unit.
        axes: (3, 3) takes tangent, bitangent and normal.
    """
    tx, ty, tz, bx, by, bz = tangent_frame(normal)
    axes[0, 0], axes[0, 1], axes[0, 2] = tx, ty, tz
    axes[1, 0], axes[1, 1], axes[1, 2] = bx, by, bz
    axes[2] = normal


@fused
def texels_of_lobes(
    axes: NDArray[np.float32],
    towards_camera: NDArray[np.float32],
    half_vectors: NDArray[np.float32],
    sizes: NDArray[np.int32],
    offsets: NDArray[np.int32],
    weights: NDArray[np.float32],
    texels: NDArray[np.int32],
) -> None:
    """Do as :func:`mirrored_texels` for the samples of several lobes, in single precision.

    That takes half the time, and the more so the more samples there are at once.

    Args:
        axes: (3, 3) of :func:`fill_axes`.
        towards_camera: (3,) unit.
        half_vectors: (3, S) unit, in the tangent frame with +z on the normal.
        sizes: (S,) edge of the octahedral map that each sample looks into.
        offsets: (S,) its first texel in an array of several maps.
        weights: (S,) as in :func:`mirrored_texels`.
        texels: (S,) takes indices into that array.
    """
    zero, half, one, two = np.float32(0.0), np.float32(0.5), np.float32(1.0), np.float32(2.0)
    tx, ty, tz = axes[0, 0], axes[0, 1], axes[0, 2]
    bx, by, bz = axes[1, 0], axes[1, 1], axes[1, 2]
    nx, ny, nz = axes[2, 0], axes[2, 1], axes[2, 2]
    ox, oy, oz = towards_camera[0], towards_camera[1], towards_camera[2]
    x, y = tx * ox + ty * oy + tz * oz, bx * ox + by * oy + bz * oz
    z = nx * ox + ny * oy + nz * oz
    inverse = one / max(z, np.float32(1e-3))
    for s in range(len(weights)):
        hx, hy, hz = half_vectors[0, s], half_vectors[1, s], half_vectors[2, s]
        along = x * hx + y * hy + z * hz
        ix, iy, iz = two * along * hx - x, two * along * hy - y, two * along * hz - z
        is_above = (along > zero) & (iz > zero)
        weight = along * hz * hz * hz * np.sqrt(max(iz, zero) * inverse)
        weights[s] = weight if is_above else zero
        wx = tx * ix + bx * iy + nx * iz
        wy = ty * ix + by * iy + ny * iz
        wz = tz * ix + bz * iy + nz * iz
        scale = one / (abs(wx) + abs(wy) + abs(wz))
        u, v = wx * scale, wy * scale
        folded_u = (one - abs(v)) * (one if u >= zero else -one)
        folded_v = (one - abs(u)) * (one if v >= zero else -one)
        u, v = (folded_u if wz < zero else u), (folded_v if wz < zero else v)
        size, last = sizes[s], sizes[s] - np.int32(1)
        scale_of_map = half * np.float32(size)
        column = min(np.int32((u + one) * scale_of_map), last)
        row = min(np.int32((v + one) * scale_of_map), last)
        texels[s] = row * size + column + offsets[s]
