# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which surface voxels a view truly sees.

All of these must hold: the voxel projects inside the image; the pixel nearest to it is foreground
within ``max_depth`` and clear of depth edges (``FramePixels.surface``); the depth there agrees with
the voxel's (``depth_tolerance``), so that nothing stands in front of it; and the angle between its
normal and the direction to the camera is at most ``max_grazing_angle``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames.depth_edges import depth_tolerance
from reflest_core.fusion.frames.foreground import FramePixels
from reflest_core.fusion.settings import FusionSettings
from reflest_core.fusion.work_sharing import share_out
from reflest_core.jit import compiled, kernel_array

LEAST_SHARE = 4096
"""Fewer voxels than this are not worth waking another thread."""


def visible_voxels(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    frame: Frame,
    pixels: FramePixels,
    settings: FusionSettings,
    threads: int = 1,
) -> tuple[NDArray[np.int64], NDArray[np.uint8]]:
    """Find the voxels that a frame truly sees, and their colours.

    Args:
        positions: (V, 3) world frame, metres.
        normals: (V, 3) unit.
        frame: The frame.
        pixels: What fusion takes of it.
        settings: ``voxel_size`` and ``max_grazing_angle``.
        threads: Threads that share the work.

    Returns:
        Indices (S,) of the seen voxels and the 8-bit sRGB colours (S, 3) where they are seen.
    """
    parts = share_out(
        threads,
        len(positions),
        LEAST_SHARE,
        _visible,
        positions,
        normals,
        kernel_array(frame.rgb, np.uint8),
        pixels.depth,
        pixels.surface,
        kernel_array(frame.T_camera_world, np.float64),
        kernel_array(frame.camera_centre, np.float64),
        frame.intrinsics.matrix,
        settings.voxel_size,
        math.cos(math.radians(settings.max_grazing_angle)),
    )
    seen, colours = zip(*parts, strict=True)
    return np.concatenate(seen), np.concatenate(colours)


@compiled
def _visible(
    start: int,
    stop: int,
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    rgb: NDArray[np.uint8],
    depth: NDArray[np.float32],
    surface: NDArray[np.bool_],
    T: NDArray[np.float64],
    camera: NDArray[np.float64],
    K: NDArray[np.float64],
    voxel_size: float,
    least_cosine: float,
) -> tuple[NDArray[np.int64], NDArray[np.uint8]]:
    height, width = depth.shape
    seen = np.empty(stop - start, np.int64)
    colours = np.empty((stop - start, 3), np.uint8)
    count = 0
    for n in range(start, stop):
        x, y, z = float(positions[n, 0]), float(positions[n, 1]), float(positions[n, 2])
        zc = T[2, 0] * x + T[2, 1] * y + T[2, 2] * z + T[2, 3]
        if zc <= 0.0:
            continue
        u = K[0, 0] * (T[0, 0] * x + T[0, 1] * y + T[0, 2] * z + T[0, 3]) / zc + K[0, 2]
        v = K[1, 1] * (T[1, 0] * x + T[1, 1] * y + T[1, 2] * z + T[1, 3]) / zc + K[1, 2]
        if not (-0.5 <= u < width - 0.5 and -0.5 <= v < height - 0.5):
            continue
        un, vn = int(u + 0.5), int(v + 0.5)
        if not surface[vn, un] or abs(zc - depth[vn, un]) > depth_tolerance(zc, voxel_size):
            continue
        dx, dy, dz = camera[0] - x, camera[1] - y, camera[2] - z
        along = dx * normals[n, 0] + dy * normals[n, 1] + dz * normals[n, 2]
        if along < least_cosine * math.sqrt(dx * dx + dy * dy + dz * dz):
            continue
        seen[count] = n
        colour_at(rgb, u, v, colours[count])
        count += 1
    return seen[:count].copy(), colours[:count].copy()


@compiled
def colour_at(rgb: NDArray[np.uint8], u: float, v: float, colour: NDArray[np.uint8]) -> None:
    """Interpolate a colour between its four nearest pixels; a kernel.

    The nearest pixel's colour would jump where the point passes from pixel to pixel, by that
    pixel's noise: a pose that is wrong by a tenth of a pixel would change one colour in five.

    Args:
        rgb: (H, W, 3) 8-bit sRGB image.
        u: Column of the point, pixels; the first pixel's centre is at 0.
        v: Row of the point, likewise.
        colour: (3,) filled, 8-bit sRGB; 255 where any of the four is, for what a sensor clipped is
            a lower bound alone.
    """
    height, width = rgb.shape[:2]
    u, v = min(max(u, 0.0), width - 1.0), min(max(v, 0.0), height - 1.0)
    left, top = int(u), int(v)
    right, bottom = min(left + 1, width - 1), min(top + 1, height - 1)
    across, down = u - left, v - top
    for channel in range(3):
        a, b = float(rgb[top, left, channel]), float(rgb[top, right, channel])
        c, d = float(rgb[bottom, left, channel]), float(rgb[bottom, right, channel])
        if max(a, b, c, d) == 255.0:
            colour[channel] = 255
            continue
        upper, lower = a + across * (b - a), c + across * (d - c)
        colour[channel] = int(upper + down * (lower - upper) + 0.5)
