# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which pixels show the scanned object, and how its depth is weighed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames.depth_edges import clear_of_edges
from reflest_core.fusion.frames.region import Region, pixels_in_region
from reflest_core.fusion.frames.slant import find_steepness
from reflest_core.fusion.settings import FusionSettings
from reflest_core.jit import compiled, kernel_array

WIDEST_MARGIN = 32
"""Pixels to the sides within which ``FramePixels.free_depth`` searches at most."""

NEAREST_DEPTH = np.float32(1e-3)
"""Metres; no camera measures less, and kernels divide by depth."""


@dataclass(frozen=True)
class FramePixels:
    """What fusion takes of a frame.

    Attributes:
        foreground: (H, W) bool; F and B are means over it and the rest (SPEC section 2).
        depth: (H, W) float32 metres, 0 where unknown.
        surface: (H, W) bool, the foreground within ``max_depth`` and clear of depth edges: what is
            fused and observed.
        steepness: (H, W) float32 in (0, 1], see :func:`.find_steepness`; 0 but on ``surface``.
        gain: (H, W) uint8 weight of the pixel's depth; 0 but on ``surface``.
        free_depth: (H, W) float32 metres, the nearest depth within the truncation distance to the
            sides, 0 where some is unknown; what is in front of it by as much is free of any
            surface.
    """

    foreground: NDArray[np.bool_]
    depth: NDArray[np.float32]
    surface: NDArray[np.bool_]
    steepness: NDArray[np.float32]
    gain: NDArray[np.uint8]
    free_depth: NDArray[np.float32]


def classify_pixels(frame: Frame, region: Region, settings: FusionSettings) -> FramePixels:
    """Tell the scanned surface from the background.

    Foreground is the mask if there is one, else the region, else depth inside ``max_depth``.

    Args:
        frame: The frame.
        region: The region of interest or the work sphere.
        settings: ``max_depth``, voxel size and margins.

    Returns:
        What fusion takes of the frame.
    """
    depth: NDArray[np.float32] = kernel_array(frame.depth, np.float32)
    depth, within_reach = _known_depth(depth, np.float32(settings.max_depth))
    K = frame.intrinsics.matrix
    if frame.mask is not None:
        foreground = kernel_array(frame.mask, np.bool_)
    elif region.shape:
        T = kernel_array(frame.T_world_camera, np.float64)
        foreground = pixels_in_region(
            depth, T, K, int(region.shape), region.centre, region.half_size
        )
    else:
        foreground = within_reach
    clear = clear_of_edges(depth, settings.voxel_size, settings.depth_edge_margin)
    surface = foreground & within_reach & clear
    steepness = np.empty(depth.shape, np.float32)
    gain = np.empty(depth.shape, np.uint8)
    find_steepness(depth, surface, settings.depth_edge_margin, K, steepness, gain)
    free_depth = _free_depth(depth, surface, frame, settings)
    return FramePixels(foreground, depth, surface, steepness, gain, free_depth)


@compiled
def _known_depth(
    depth: NDArray[np.float32], max_depth: np.float32
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Depth with 0 where it is unknown, and where it is known and within reach."""
    known, is_within = np.empty(depth.size, np.float32), np.empty(depth.size, np.bool_)
    of_pixels = depth.reshape(-1)
    for n in range(len(of_pixels)):
        z = of_pixels[n]
        is_known = (z >= NEAREST_DEPTH) & (z < np.inf)
        known[n] = z if is_known else np.float32(0.0)
        is_within[n] = is_known & (z <= max_depth)
    return known.reshape(depth.shape), is_within.reshape(depth.shape)


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
