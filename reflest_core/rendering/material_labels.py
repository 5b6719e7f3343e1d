# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which material is where: in a camera's image, at a point, and in colours that distinguish ids."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.surface.partition import UNASSIGNED

PALETTE = (
    (230, 159, 0),
    (86, 180, 233),
    (0, 158, 115),
    (240, 228, 66),
    (0, 114, 178),
    (213, 94, 0),
    (204, 121, 167),
)
"""8-bit sRGB of the first ids, distinguishable for colour-blind eyes (Okabe and Ito 2008)."""

GOLDEN = 0.618033988749895
"""Share of a turn between the hues of the ids after the palette's."""

NOTHING = -1
"""Where no voxel is seen."""

WIDEST_SPLAT = 12
"""Pixels from a voxel's centre to the edge of the square that it covers, at most."""

OPACITY = 0.45
"""Of the labels over the image."""

OUTSIDE = 0.4
"""Brightness of what is outside of the scan's bounds, over that of the image."""


@dataclass(frozen=True)
class CameraView:
    """A camera at a pose.

    Attributes:
        intrinsics: Of the image.
        T_world_camera: (4, 4) float64, optical frame to world.
    """

    intrinsics: CameraIntrinsics
    T_world_camera: NDArray[np.float64]


def material_colour(material_id: int) -> tuple[int, int, int]:
    """Choose a colour for an id; the same id has the same colour everywhere.

    Args:
        material_id: Of a material map; :data:`.UNASSIGNED` is grey.

    Returns:
        8-bit sRGB.
    """
    if material_id == UNASSIGNED:
        return (128, 128, 128)
    if material_id <= len(PALETTE):
        return PALETTE[material_id - 1]
    turn = material_id - len(PALETTE)
    value = 0.95 if turn % 2 else 0.65
    red, green, blue = colorsys.hsv_to_rgb((GOLDEN * turn) % 1.0, 0.7, value)
    return (round(255 * red), round(255 * green), round(255 * blue))


def material_colours(material_ids: NDArray[np.integer]) -> NDArray[np.uint8]:
    """Choose a colour for each id.

    Args:
        material_ids: (N,) ids.

    Returns:
        (N, 3) 8-bit sRGB.
    """
    found, places = np.unique(material_ids, return_inverse=True)
    colours = [material_colour(int(one)) for one in found]
    return np.array(colours, np.uint8).reshape(-1, 3)[places]


def voxels_in_image(
    positions: NDArray[np.floating], view: CameraView, voxel_size: float
) -> NDArray[np.int64]:
    """Find the nearest voxel behind each pixel.

    Args:
        positions: (V, 3) surface points, world frame, metres.
        view: The camera.
        voxel_size: Edge of a voxel, metres.

    Returns:
        (H, W) indices of voxels, :data:`NOTHING` where none is seen.
    """
    camera = view.intrinsics
    rotation, centre = view.T_world_camera[:3, :3], view.T_world_camera[:3, 3]
    in_camera = (positions.astype(np.float64) - centre) @ rotation
    z = in_camera[:, 2]
    seen = np.flatnonzero(z > voxel_size)
    z = z[seen]
    u = np.floor(camera.fx * in_camera[seen, 0] / z + camera.cx + 0.5)
    v = np.floor(camera.fy * in_camera[seen, 1] / z + camera.cy + 0.5)
    edge = np.clip(np.ceil(0.6 * voxel_size * camera.fx / z), 1, WIDEST_SPLAT).astype(np.int64)
    near = (np.abs(u) < 2.0**30) & (np.abs(v) < 2.0**30)
    seen, z, edge = seen[near], z[near], edge[near]
    u, v = u[near].astype(np.int64), v[near].astype(np.int64)
    # Depth in tenths of a millimetre above the index: the least of both is the nearest voxel.
    code = np.minimum(z * 1e4, 2.0**30).astype(np.int64) << 32 | seen
    empty = np.iinfo(np.int64).max
    image = np.full(camera.height * camera.width, empty, np.int64)
    for down in range(-WIDEST_SPLAT, WIDEST_SPLAT + 1):
        for across in range(-WIDEST_SPLAT, WIDEST_SPLAT + 1):
            x, y = u + across, v + down
            covers = (
                (edge >= max(abs(down), abs(across)))
                & (x >= 0)
                & (x < camera.width)
                & (y >= 0)
                & (y < camera.height)
            )
            if covers.any():
                pixels = y[covers] * camera.width + x[covers]
                np.minimum.at(image, pixels, code[covers])
    indices = np.where(image == empty, NOTHING, image & 0xFFFFFFFF)
    return indices.reshape(camera.height, camera.width)


def labels_over(
    rgb: NDArray[np.uint8],
    voxels: NDArray[np.int64],
    material_ids: NDArray[np.integer],
    is_scanned: NDArray[np.bool_] | None = None,
) -> NDArray[np.uint8]:
    """Draw the materials over an image, and darken what is not scanned.

    Args:
        rgb: (H, W, 3) 8-bit sRGB.
        voxels: (H, W) of :func:`voxels_in_image`.
        material_ids: (V,) id of each voxel.
        is_scanned: (H, W) pixels within the scan's bounds; None darkens nothing.

    Returns:
        (H, W, 3) 8-bit sRGB: each material in its colour, with a dark outline; what is neither
        a material nor within the bounds is dark.
    """
    ids = np.where(voxels >= 0, np.append(material_ids.astype(np.int64), NOTHING)[voxels], NOTHING)
    colours = material_colours(np.maximum(ids, 0).reshape(-1)).reshape(rgb.shape)
    mixed = rgb + OPACITY * (colours.astype(np.float32) - rgb)
    rest = rgb
    if is_scanned is not None:
        rest = np.where(is_scanned[..., None], rgb, (OUTSIDE * rgb).astype(np.uint8))
    drawn = np.where((ids >= 0)[..., None], mixed, rest).round().astype(np.uint8)
    narrow = ids.astype(np.float32)
    kernel = np.ones((3, 3), np.uint8)
    drawn[cv2.dilate(narrow, kernel) != cv2.erode(narrow, kernel)] = 20
    return drawn


def voxel_near(
    positions: NDArray[np.floating], point: NDArray[np.float64], reach: float
) -> int | None:
    """Find the voxel nearest to a point.

    Args:
        positions: (V, 3) surface points, metres.
        point: (3,) in the same frame.
        reach: Farthest distance, metres.

    Returns:
        Its index, or None where none is within reach.
    """
    if not len(positions):
        return None
    away = np.linalg.norm(positions.astype(np.float64) - point, axis=1)
    nearest = int(away.argmin())
    return nearest if away[nearest] <= reach else None
