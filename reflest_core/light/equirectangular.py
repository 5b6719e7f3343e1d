# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Equirectangular images of all directions: the one convention of the package, and its look-up.

z is up: row 0 touches +z, the last row -z. A direction of azimuth ``phi = atan2(y, x)`` lies at
the column ``u = 0.5 - phi / (2 pi)`` (a fraction of the width): +x is in the middle, +y a quarter
of the width to its left, -y to its right, -x at both edges. So the image shows what somebody at its
centre sees, unmirrored; OpenEXR's lat-long maps have the same handedness.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def equirectangular_directions(height: int) -> NDArray[np.float64]:
    """Return the directions of the pixels.

    Args:
        height: Rows of the image; it has twice as many columns.

    Returns:
        (height, 2 height, 3) unit vectors through the pixels' centres.
    """
    polar = (np.arange(height) + 0.5) / height * np.pi
    azimuth = (0.5 - (np.arange(2 * height) + 0.5) / (2 * height)) * 2.0 * np.pi
    sine = np.sin(polar)[:, None]
    return np.stack(
        np.broadcast_arrays(sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(polar)[:, None]),
        axis=-1,
    )


def equirectangular_solid_angles(height: int) -> NDArray[np.float64]:
    """Return the solid angle that a pixel of each row covers.

    Args:
        height: Rows of the image; it has twice as many columns.

    Returns:
        (height, 1) steradians; all pixels make 4 pi.
    """
    edges = np.cos(np.linspace(0.0, np.pi, height + 1))
    return (edges[:-1] - edges[1:])[:, None] * np.pi / height


def radiance_from(
    environment: NDArray[np.float32], directions: NDArray[np.floating[Any]]
) -> NDArray[np.float32]:
    """Look an environment up, bilinearly between the centres of its pixels.

    Args:
        environment: (H, W, C) equirectangular image.
        directions: (R, 3) unit vectors.

    Returns:
        (R, C) float32, what is seen along each direction.
    """
    height, width = environment.shape[:2]
    row, column = _place(directions.astype(np.float64), height, width)
    row, column = np.clip(row - 0.5, 0.0, height - 1.0), column - 0.5
    left, top = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
    across, down = (column - left)[:, None], (row - top)[:, None]
    bottom = np.minimum(top + 1, height - 1)
    upper, lower = (
        environment[line, left % width] * (1.0 - across)
        + environment[line, (left + 1) % width] * across
        for line in (top, bottom)
    )
    return np.asarray(upper * (1.0 - down) + lower * down, np.float32)


def nearest_radiance(
    environment: NDArray[np.float32], directions: NDArray[np.floating[Any]]
) -> NDArray[np.float64]:
    """Look an environment up in its nearest pixels: fast, where many samples are averaged.

    Args:
        environment: (H, W, C) equirectangular image.
        directions: (..., 3) unit vectors.

    Returns:
        (..., C) what is seen along each direction.
    """
    height, width = environment.shape[:2]
    row, column = _place(directions, height, width)
    rows = np.clip(row.astype(np.int64), 0, height - 1)
    found: NDArray[np.float64] = environment[
        rows, np.floor(column).astype(np.int64) % width
    ].astype(np.float64)
    return found


def _place(
    directions: NDArray[np.floating[Any]], height: int, width: int
) -> tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]:
    """Row and column of directions, in pixels from the image's upper left corner."""
    x, y, z = directions[..., 0], directions[..., 1], directions[..., 2]
    column = (0.5 - np.arctan2(y, x) / (2.0 * np.pi)) * width
    return np.arccos(np.clip(z, -1.0, 1.0)) / np.pi * height, column
