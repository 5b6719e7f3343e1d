# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How steeply each pixel's surface is seen, from the depth image alone.

With ``a, b`` the pixel in normalised coordinates, ``r = (a, b, 1)`` its ray and
``p = fx z_u / z``, ``q = fy z_v / z`` the relative slopes of the depth, the surface has the normal
``n = (-p, -q, 1 + a p + b q)`` in the camera frame, and ``n . r = 1``. A point on the same ray at
depth ``z'`` is therefore ``(z - z') / |n|`` from the tangent plane; ``1 / |n|`` is the steepness.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled

FULL_WEIGHT = 16
"""Weight of a surface seen head-on; it falls with the squared cosine of the viewing angle, to 0
beyond 80 degrees, where curvature spoils the distance to the tangent plane."""


@compiled
def find_steepness(
    start: int,
    stop: int,
    depth: NDArray[np.float32],
    surface: NDArray[np.bool_],
    reach: int,
    K: NDArray[np.float64],
    steepness: NDArray[np.float32],
    gain: NDArray[np.uint8],
) -> None:
    """Fill in how steeply the surface is seen and what its depth weighs; a kernel.

    Args:
        start: First of the rows that are filled.
        stop: The one after the last.
        depth: (H, W) metres.
        surface: (H, W) pixels with a continuous surface for ``reach`` pixels to all sides.
        reach: Pixels over which slopes are measured.
        K: (3, 3) intrinsics.
        steepness: (H, W) filled with ``1 / |n|``; 0 off the surface.
        gain: (H, W) filled with weights; 0 off the surface.
    """
    height, width = depth.shape
    for v in range(start, stop):
        above, below = max(v - reach, 0), min(v + reach, height - 1)
        steepness[v] = np.float32(0.0)
        gain[v] = 0
        u, last = _surface_range(surface[v])
        while u < last:
            # The inner columns at once; at the borders the window is cut off.
            is_inner = reach <= u < width - reach
            first, end = (reach, min(width - reach, last)) if is_inner else (u, u + 1)
            left, right = max(u - reach, 0), min(u + reach, width - 1)
            _fill(
                depth[v, u:end],
                depth[v, left:],
                depth[v, right:],
                depth[above, u:],
                depth[below, u:],
                surface[v, u:],
                first,
                u - first,
                v,
                right - left,
                below - above,
                K,
                steepness[v, u:],
                gain[v, u:],
            )
            u = end


@compiled
def _surface_range(surface: NDArray[np.bool_]) -> tuple[int, int]:
    """The first pixel of a row on the surface, and the one after the last; the row's end twice."""
    first, last = 0, len(surface)
    while first < last and not surface[first]:
        first += 1
    while first < last and not surface[last - 1]:
        last -= 1
    return first, last


@compiled
def _fill(
    depth: NDArray[np.float32],
    left: NDArray[np.float32],
    right: NDArray[np.float32],
    above: NDArray[np.float32],
    below: NDArray[np.float32],
    surface: NDArray[np.bool_],
    u: int,
    skipped: int,
    v: int,
    across: int,
    down: int,
    K: NDArray[np.float64],
    steepness: NDArray[np.float32],
    gain: NDArray[np.uint8],
) -> None:
    """A piece of row ``v``, ``skipped`` after column ``u``; for vector instructions."""
    zero, half, one = np.float32(0.0), np.float32(0.5), np.float32(1.0)
    full = np.float32(FULL_WEIGHT)
    first, step = np.float32((u - K[0, 2]) / K[0, 0]), np.float32(1.0 / K[0, 0])
    b = np.float32((v - K[1, 2]) / K[1, 1])
    along_u, along_v = np.float32(K[0, 0] / across), np.float32(K[1, 1] / down)
    for n in range(len(depth)):
        is_on = surface[n]
        a = first + np.float32(np.int32(n + skipped)) * step
        inverse = one / (depth[n] if is_on else one)
        p = along_u * (right[n] - left[n]) * inverse
        q = along_v * (below[n] - above[n]) * inverse
        along = one + a * p + b * q
        square = one / (p * p + q * q + along * along)
        weight = full * square / (one + a * a + b * b)
        steepness[n] = np.sqrt(square) if is_on else zero
        gain[n] = np.uint8(np.int32((weight if is_on else zero) + half))
