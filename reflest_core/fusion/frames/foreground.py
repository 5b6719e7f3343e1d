# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which pixels show the scanned object, how its depth is weighed, and the mean colours F and B."""

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
from reflest_core.fusion.work_sharing import share_out
from reflest_core.jit import compiled, kernel_array, vectorised

WIDEST_MARGIN = 32
"""Pixels to the sides within which ``FramePixels.free_depth`` searches at most."""

LEAST_SHARE = 100_000
"""Fewer pixels than this are not worth waking another thread."""

NEAREST_DEPTH = np.float32(1e-3)
"""Metres; no camera measures less, and kernels divide by depth."""


@dataclass(frozen=True)
class FramePixels:
    """What fusion takes of a frame.

    Attributes:
        foreground: (H, W) bool; F and B are means over it and over the rest.
        depth: (H, W) float32 metres, 0 where unknown.
        surface: (H, W) bool, the foreground within ``max_depth`` and clear of depth edges: what is
            fused and observed.
        steepness: (H, W) float32 in (0, 1], see :func:`.find_steepness`; 0 but on ``surface``.
        gain: (H, W) uint8 weight of the pixel's depth; 0 but on ``surface``.
        free_depth: (H, W) float32 metres, the nearest depth within the truncation distance to the
            sides, 0 where some is unknown; what is in front of it by as much is free of any
            surface.
        farthest: The largest depth on ``surface``, metres; 0 where it is empty.
    """

    foreground: NDArray[np.bool_]
    depth: NDArray[np.float32]
    surface: NDArray[np.bool_]
    steepness: NDArray[np.float32]
    gain: NDArray[np.uint8]
    free_depth: NDArray[np.float32]
    farthest: float


def classify_pixels(frame: Frame, region: Region, settings: FusionSettings) -> FramePixels:
    """Separate the scanned surface from the background.

    Foreground is the mask if there is one, else the region, else depth inside ``max_depth``.

    Args:
        frame: The frame.
        region: The region of interest or the work sphere.
        settings: ``max_depth``, voxel size and margins.

    Returns:
        What fusion takes of the frame.
    """
    depth, surface = _known_depth(
        kernel_array(frame.depth, np.float32), np.float32(settings.max_depth)
    )
    foreground = surface.copy() if frame.mask is None else kernel_array(frame.mask, np.bool_)
    steepness = np.empty(depth.shape, np.float32)
    gain = np.empty(depth.shape, np.uint8)
    height, width = depth.shape
    sharing = settings.threads, height, math.ceil(LEAST_SHARE / width)
    arrays = depth, foreground, surface, steepness, gain
    ranges = share_out(*sharing, _classify_rows, frame, region, settings, *arrays)
    nearest, farthest = min(near for near, _ in ranges), max(far for _, far in ranges)
    free_depth = np.empty_like(depth)
    margin = _side_margin(nearest, frame, settings)
    share_out(*sharing, _erode_rows, depth, margin, free_depth)
    return FramePixels(foreground, depth, surface, steepness, gain, free_depth, farthest)


def _classify_rows(
    start: int,
    stop: int,
    frame: Frame,
    region: Region,
    settings: FusionSettings,
    depth: NDArray[np.float32],
    foreground: NDArray[np.bool_],
    surface: NDArray[np.bool_],
    steepness: NDArray[np.float32],
    gain: NDArray[np.uint8],
) -> tuple[float, float]:
    """Fill in rows of the last four; ``surface`` holds where depth is within reach, before.

    Returns the least and the largest depth on the surface, infinite and 0 where there is none.
    """
    K, margin = frame.intrinsics.matrix, settings.depth_edge_margin
    if frame.mask is None and region.shape:
        pixels_in_region(
            start,
            stop,
            depth,
            kernel_array(frame.T_world_camera, np.float64),
            K,
            int(region.shape),
            region.centre,
            region.half_size,
            foreground,
        )
    above = max(start - margin, 0)
    clear = clear_of_edges(depth[above : stop + margin], settings.voxel_size, margin)
    surface[start:stop] &= foreground[start:stop] & clear[start - above : stop - above]
    find_steepness(start, stop, depth, surface, margin, K, steepness, gain)
    return _depth_range(depth[start:stop], surface[start:stop])


@vectorised
def _depth_range(depth: NDArray[np.float32], surface: NDArray[np.bool_]) -> tuple[float, float]:
    nearest, farthest = np.float32(np.inf), np.float32(0.0)
    for v in range(len(depth)):
        for u in range(depth.shape[1]):  # ``min`` makes no vector instruction of float32
            near = depth[v, u] if surface[v, u] else np.float32(np.inf)
            far = depth[v, u] if surface[v, u] else np.float32(0.0)
            nearest = near if near < nearest else nearest
            farthest = far if far > farthest else farthest
    return float(nearest), float(farthest)


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


def _side_margin(nearest: float, frame: Frame, settings: FusionSettings) -> int:
    """The truncation distance in pixels, where the surface is nearest."""
    focal_length = max(frame.intrinsics.fx, frame.intrinsics.fy)
    nearest = min(nearest, settings.max_depth)
    margin = math.ceil(settings.truncation * settings.voxel_size * focal_length / nearest)
    return min(margin, WIDEST_MARGIN)


def _erode_rows(
    start: int,
    stop: int,
    depth: NDArray[np.float32],
    margin: int,
    free_depth: NDArray[np.float32],
) -> None:
    window, above = np.ones((2 * margin + 1, 2 * margin + 1), np.uint8), max(start - margin, 0)
    eroded = np.asarray(cv2.erode(depth[above : stop + margin], window), np.float32)
    free_depth[start:stop] = eroded[start - above : stop - above]


def foreground_background_means(
    rgb: NDArray[np.uint8], foreground: NDArray[np.bool_]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return F and B, the mean colours of foreground and background (paper, Sec. 3 and Eq. 4).

    Args:
        rgb: (H, W, 3) 8-bit sRGB.
        foreground: (H, W) bool; the background is the rest.

    Returns:
        F and B, each (3,) float32 in [0, 255]; NaN where no pixel is.
    """
    sums, counts = _sum_colours(kernel_array(rgb, np.uint8), kernel_array(foreground, np.bool_))
    means = np.full((2, 3), np.nan, np.float32)
    for n in range(2):
        if counts[n]:
            means[n] = sums[n] / counts[n]
    return means[1], means[0]


@compiled
def _sum_colours(
    rgb: NDArray[np.uint8], foreground: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Exact integer sums (2, 3) and counts (2,), background first."""
    sums = np.zeros((2, 3), np.int64)
    counts = np.zeros(2, np.int64)
    height, width = foreground.shape
    for v in range(height):
        # Sums of one row fit into 32 bits, and vector instructions take twice as many of those.
        inside, red, green, blue = np.uint32(0), np.uint32(0), np.uint32(0), np.uint32(0)
        all_red, all_green, all_blue = np.uint32(0), np.uint32(0), np.uint32(0)
        row, is_inside = rgb[v].reshape(3 * width), foreground[v]
        for u in range(width):
            one = np.uint32(is_inside[u])
            r = np.uint32(row[3 * u])
            g = np.uint32(row[3 * u + 1])
            b = np.uint32(row[3 * u + 2])
            inside += one
            red += r * one
            green += g * one
            blue += b * one
            all_red += r
            all_green += g
            all_blue += b
        counts[0] += width - np.int64(inside)
        counts[1] += np.int64(inside)
        for side, colours in enumerate(
            ((all_red - red, all_green - green, all_blue - blue), (red, green, blue))
        ):
            for channel in range(3):
                sums[side, channel] += np.int64(colours[channel])
    return sums, counts
