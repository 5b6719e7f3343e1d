# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""All painted panels of a room in one texture and one mesh."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.room.geometry import ATLAS_TILES, FloatArray, Panel
from reflest_core.synbrdf.room.paint import TEXELS

TILES_ACROSS = 8


def atlas(tiles: list[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Join tiles (TEXELS, TEXELS, 3), at most ATLAS_TILES, to one image of a fixed size.

    Args:
        tiles: (h, w, 3) images.
    """
    rows = ATLAS_TILES // TILES_ACROSS
    image = np.zeros((rows * TEXELS, TILES_ACROSS * TEXELS, 3), np.float32)
    for number, tile in enumerate(tiles):
        row, column = (TEXELS * k for k in divmod(number, TILES_ACROSS))
        image[row : row + TEXELS, column : column + TEXELS] = tile
    return image


def panel_mesh(
    panels: list[Panel],
) -> tuple[FloatArray, NDArray[np.float32], NDArray[np.uint32]]:
    """Vertices (4 P, 3), their places (4 P, 2) in the atlas, and faces (2 P, 3).

    Places keep half a texel off the edges of a tile, so that none shows its neighbour's paint.

    Args:
        panels: rectangles with their radiance.
    """
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float64)
    vertices, places = [], []
    for number, panel in enumerate(panels):
        row, column = divmod(number, TILES_ACROSS)
        vertices.append(panel.corner + corners @ np.stack([panel.across, panel.up]))
        inner = (corners * (TEXELS - 1) + 0.5) / TEXELS + [column, row]
        places.append(inner / [TILES_ACROSS, ATLAS_TILES // TILES_ACROSS])
    first = 4 * np.arange(len(panels))[:, None, None]
    faces = (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    return (
        np.concatenate(vertices),
        np.concatenate(places).astype(np.float32),
        faces.astype(np.uint32),
    )


def spread(light: NDArray[np.float32]) -> NDArray[np.float32]:
    """Interpolate coarse texels (H, W, 3) to a tile.

    Args:
        light: (N, N, 3) linear radiance.
    """
    size = (TEXELS, TEXELS)
    return np.asarray(cv2.resize(light, size, interpolation=cv2.INTER_LINEAR), np.float32)
