"""Which pixels show the scanned object, and what the depth image tells about it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.depth_edges import clear_of_edges
from reflest_core.fusion.region import Region, inside_region
from reflest_core.fusion.settings import FusionSettings
from reflest_core.fusion.slant import surface_slant
from reflest_core.jit import compiled, kernel_array

WIDEST_MARGIN = 32
"""Pixels to the sides within which ``FramePixels.free_depth`` looks at most."""


@dataclass(frozen=True)
class FramePixels:
    """``foreground``: (H, W) bool, by SPEC section 2 (F and B are means over it and the rest).

    ``depth``: (H, W) float32 metres, 0 where unknown. ``surface``: (H, W) bool, the foreground
    within ``max_depth`` and clear of depth edges: what is fused and observed. ``slant``: (H, W)
    float32, see :func:`surface_slant`, 0 but on ``surface``. ``free_depth``: (H, W) float32 metres,
    the nearest depth within the truncation distance to the sides, 0 where some is unknown; what is
    in front of it by as much is free of any surface.
    """

    foreground: NDArray[np.bool_]
    depth: NDArray[np.float32]
    surface: NDArray[np.bool_]
    slant: NDArray[np.float32]
    free_depth: NDArray[np.float32]


def classify_pixels(frame: Frame, region: Region, settings: FusionSettings) -> FramePixels:
    """Foreground is the mask if there is one, else the region, else depth inside ``max_depth``."""
    depth: NDArray[np.float32] = kernel_array(frame.depth, np.float32)
    is_known = np.isfinite(depth) & (depth > 0.0)
    depth = np.where(is_known, depth, np.float32(0.0))
    within_reach = is_known & (depth <= settings.max_depth)
    if frame.mask is not None:
        foreground = kernel_array(frame.mask, np.bool_)
    elif region.shape:
        camera = frame.intrinsics
        foreground = _in_region(
            depth, kernel_array(frame.T_world_camera, np.float64),
            camera.fx, camera.fy, camera.cx, camera.cy,
            int(region.shape), region.centre, region.half_size,
        )  # fmt: skip
    else:
        foreground = within_reach
    clear = clear_of_edges(depth, settings.voxel_size, settings.depth_edge_margin)
    surface = foreground & within_reach & clear
    slant = surface_slant(depth, surface, settings.depth_edge_margin, frame.intrinsics.matrix)
    free_depth = _free_depth(depth, surface, frame, settings)
    return FramePixels(foreground, depth, surface, slant, free_depth)


def _free_depth(
    depth: NDArray[np.float32],
    surface: NDArray[np.bool_],
    frame: Frame,
    settings: FusionSettings,
) -> NDArray[np.float32]:
    nearest = float(np.min(depth, where=surface, initial=settings.max_depth))
    focal_length = max(frame.intrinsics.fx, frame.intrinsics.fy)
    margin = math.ceil(settings.truncation * settings.voxel_size * focal_length / nearest)
    size = 2 * min(margin, WIDEST_MARGIN) + 1
    return np.asarray(cv2.erode(depth, np.ones((size, size), np.uint8)), np.float32)


@compiled
def _in_region(
    depth: NDArray[np.float32],
    T: NDArray[np.float64],
    fx: float,
    fy: float,
    cx: float,
    cy: float,
    shape: int,
    centre: NDArray[np.float64],
    half_size: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """(H, W) bool: pixels with depth whose back-projected point lies in the region."""
    height, width = depth.shape
    inside = np.zeros((height, width), np.bool_)
    for v in range(height):
        for u in range(width):
            z = float(depth[v, u])
            if z <= 0.0:
                continue
            x, y = (u - cx) / fx * z, (v - cy) / fy * z
            inside[v, u] = inside_region(
                shape, centre, half_size,
                T[0, 0] * x + T[0, 1] * y + T[0, 2] * z + T[0, 3],
                T[1, 0] * x + T[1, 1] * y + T[1, 2] * z + T[1, 3],
                T[2, 0] * x + T[2, 1] * y + T[2, 2] * z + T[2, 3],
            )  # fmt: skip
    return inside
