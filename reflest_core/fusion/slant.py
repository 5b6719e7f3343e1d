"""How steeply each pixel's surface is seen, from the depth image alone.

With ``a, b`` the pixel in normalised coordinates, ``r = (a, b, 1)`` its ray and
``p = fx z_u / z``, ``q = fy z_v / z`` the relative slopes of the depth, the surface has the normal
``n = (-p, -q, 1 + a p + b q)`` in the camera frame, and ``n . r = 1``. A point on the same ray at
depth ``z'`` is therefore ``(z - z') / |n|`` from the tangent plane.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled


@compiled
def surface_slant(
    depth: NDArray[np.float32], clear: NDArray[np.bool_], reach: int, K: NDArray[np.float64]
) -> NDArray[np.float32]:
    """(H, W) float32: ``|n|`` of the ``clear`` pixels, 0 elsewhere.

    ``depth``: (H, W) metres. ``clear``: pixels with a continuous surface for ``reach`` pixels to
    all sides. ``K``: (3, 3).
    """
    height, width = depth.shape
    slant = np.zeros((height, width), np.float32)
    for v in range(height):
        above, below = max(v - reach, 0), min(v + reach, height - 1)
        b = (v - K[1, 2]) / K[1, 1]
        for u in range(width):
            if not clear[v, u]:
                continue
            left, right = max(u - reach, 0), min(u + reach, width - 1)
            a = (u - K[0, 2]) / K[0, 0]
            p = K[0, 0] * (depth[v, right] - depth[v, left]) / ((right - left) * depth[v, u])
            q = K[1, 1] * (depth[below, u] - depth[above, u]) / ((below - above) * depth[v, u])
            along = 1.0 + a * p + b * q
            slant[v, u] = math.sqrt(p * p + q * q + along * along)
    return slant
