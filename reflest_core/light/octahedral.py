# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Octahedral maps: square images of all directions.

Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors". A unit
vector is projected onto the octahedron ``|x| + |y| + |z| = 1``; the lower half is folded outwards.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled


@compiled
def octahedral_texel(x: float, y: float, z: float, size: int) -> tuple[int, int]:
    """Find the texel that holds a direction; a kernel.

    Args:
        x: Of the direction, whose length may be anything but 0.
        y: The same.
        z: The same.
        size: Texels along an edge.

    Returns:
        Row and column.
    """
    norm = abs(x) + abs(y) + abs(z)
    u, v = x / norm, y / norm
    if z < 0.0:
        u, v = (
            (1.0 - abs(v)) * (1.0 if u >= 0.0 else -1.0),
            (1.0 - abs(u)) * (1.0 if v >= 0.0 else -1.0),
        )
    column = min(max(int((u + 1.0) * 0.5 * size), 0), size - 1)
    row = min(max(int((v + 1.0) * 0.5 * size), 0), size - 1)
    return row, column


def octahedral_texels(directions: NDArray[np.floating], size: int) -> NDArray[np.int64]:
    """Find the texels that hold directions, as :func:`octahedral_texel` does.

    Args:
        directions: (..., 3), any length but 0.
        size: Texels along an edge.

    Returns:
        (...) indices into the flat map.
    """
    norm = np.abs(directions).sum(axis=-1)
    u, v = directions[..., 0] / norm, directions[..., 1] / norm
    is_below = directions[..., 2] < 0.0
    folded_u = (1.0 - np.abs(v)) * np.where(u >= 0.0, 1.0, -1.0)
    folded_v = (1.0 - np.abs(u)) * np.where(v >= 0.0, 1.0, -1.0)
    column, row = (
        np.clip(((place + 1.0) * 0.5 * size).astype(np.int64), 0, size - 1)
        for place in (np.where(is_below, folded_u, u), np.where(is_below, folded_v, v))
    )
    return np.asarray(row * size + column)


def octahedral_directions(size: int) -> NDArray[np.float32]:
    """Return the directions of a map's texels.

    Args:
        size: Texels along an edge.

    Returns:
        (size, size, 3) unit vectors through the texels' centres.
    """
    points = _points(size)
    unit: NDArray[np.float64] = points / np.linalg.norm(points, axis=-1, keepdims=True)
    return unit.astype(np.float32)


@cache
def octahedral_solid_angles(size: int) -> NDArray[np.float32]:
    """Return the solid angles of a map's texels.

    A patch ``dA`` of the map lies on a face at the point ``p`` and is seen under ``dA / |p|^3``.

    Args:
        size: Texels along an edge.

    Returns:
        (size, size) steradians; they sum to 4 pi.
    """
    angles = (2.0 / size) ** 2 / np.linalg.norm(_points(size), axis=-1) ** 3
    return np.asarray(angles * (4.0 * np.pi / angles.sum()), np.float32)


def _points(size: int) -> NDArray[np.float64]:
    """Points (size, size, 3) on the octahedron below the texels' centres."""
    centres = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    u, v = np.meshgrid(centres, centres)
    z = 1.0 - np.abs(u) - np.abs(v)
    is_below = z < 0.0
    x = np.where(is_below, (1.0 - np.abs(v)) * np.where(u >= 0.0, 1.0, -1.0), u)
    y = np.where(is_below, (1.0 - np.abs(u)) * np.where(v >= 0.0, 1.0, -1.0), v)
    return np.stack([x, y, z], axis=-1)
