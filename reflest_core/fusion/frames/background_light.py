# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which pixels of a frame show the light around the object, and where the object sees them."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.jit import compiled, kernel_array

ACROSS = 80
"""Pixels taken along an image row: under a degree apart, finer than a texel of the light map."""
MARGIN = 3
"""Pixels from the object within which its colour may have bled into the background."""


def background_pixels(
    frame: Frame,
    foreground: NDArray[np.bool_],
    depth: NDArray[np.float32],
    object_centre: NDArray[np.floating],
    object_radius: float = 0.0,
) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """Gather a grid of background pixels as light.

    A pixel with depth is a point in the room and lies in the direction in which the object sees it;
    one without is taken to be far away. Points near the object are left out: they are its own, or
    touch it, and each of its sides sees them elsewhere.

    Args:
        frame: The frame.
        foreground: (H, W) bool, pixels on the scanned surface.
        depth: (H, W) metres, 0 or not finite where unknown.
        object_centre: (3,) world frame, metres.
        object_radius: Metres; points nearer to the centre than this are left out.

    Returns:
        Directions (P, 3), world frame, any length, and colours (P, 3) uint8, 8-bit sRGB.
    """
    camera = frame.intrinsics
    step = sampling_step(frame)
    return _gather(
        kernel_array(frame.rgb, np.uint8),
        kernel_array(foreground, np.bool_),
        kernel_array(depth, np.float32),
        kernel_array(frame.T_world_camera, np.float64),
        camera.fx,
        camera.fy,
        camera.cx,
        camera.cy,
        np.asarray(object_centre, np.float64),
        float(object_radius),
        step,
    )


def sampling_step(frame: Frame) -> int:
    """Return the distance between two pixels that are taken; the first is at half a step.

    Args:
        frame: The frame.

    Returns:
        Pixels along each axis.
    """
    return max(frame.intrinsics.width // ACROSS, 1)


def without_holes(
    depth: NDArray[np.float32], foreground: NDArray[np.bool_], step: int
) -> NDArray[np.bool_]:
    """Add to the foreground what lacks depth within it: dark or shining surface, and no light.

    A hole is a connected set of pixels without depth that does not touch the image's border and
    whose neighbours with depth are mostly foreground.

    Args:
        depth: (H, W) metres, 0 or not finite where unknown.
        foreground: (H, W) pixels on the scanned surface.
        step: Only every ``step``-th pixel, from ``step // 2`` on, is read and changed.

    Returns:
        (H, W) the foreground with its holes.
    """
    grid = (slice(step // 2, None, step), slice(step // 2, None, step))
    unknown, inside = ~(depth[grid] > 0.0), foreground[grid]
    count, labels, stats, _ = cv2.connectedComponentsWithStats(unknown.astype(np.uint8))
    height, width = unknown.shape
    left, top, across, down = stats[:, :4].T
    is_within = (left > 0) & (top > 0) & (left + across < width) & (top + down < height)
    around = cv2.dilate(labels.astype(np.float32), np.ones((3, 3))).astype(np.int64)
    ring = ~unknown & (around > 0)
    beside = np.bincount(around[ring], minlength=count)
    of_surface = np.bincount(around[ring], weights=inside[ring], minlength=count)
    is_hole = is_within & (2.0 * of_surface > beside)
    is_hole[0] = False
    filled = foreground.copy()
    filled[grid] |= is_hole[labels]
    return filled


@compiled
def _gather(
    rgb: NDArray[np.uint8],
    foreground: NDArray[np.bool_],
    depth: NDArray[np.float32],
    T: NDArray[np.float64],
    fx: float,
    fy: float,
    cx: float,
    cy: float,
    centre: NDArray[np.float64],
    radius: float,
    step: int,
) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    height, width = foreground.shape
    most = (height // step + 1) * (width // step + 1)
    directions = np.empty((most, 3), np.float32)
    colours = np.empty((most, 3), np.uint8)
    count = 0
    for v in range(step // 2, height, step):
        for u in range(step // 2, width, step):
            if _is_near(foreground, v, u):
                continue
            x, y, z = (u - cx) / fx, (v - cy) / fy, 1.0
            is_far = not depth[v, u] > 0.0
            scale = 1.0 if is_far else float(depth[v, u])
            for axis in range(3):
                turned = (T[axis, 0] * x + T[axis, 1] * y + T[axis, 2] * z) * scale
                offset = 0.0 if is_far else T[axis, 3] - centre[axis]
                directions[count, axis] = turned + offset
                colours[count, axis] = rgb[v, u, axis]
            squared = 0.0
            for axis in range(3):
                squared += directions[count, axis] ** 2
            if squared > (0.0 if is_far else radius**2):
                count += 1
    return directions[:count], colours[:count]


@compiled
def _is_near(foreground: NDArray[np.bool_], v: int, u: int) -> bool:
    height, width = foreground.shape
    for row in (max(v - MARGIN, 0), v, min(v + MARGIN, height - 1)):
        for column in (max(u - MARGIN, 0), u, min(u + MARGIN, width - 1)):
            if foreground[row, column]:
                return True
    return False
