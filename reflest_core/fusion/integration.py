"""Depth into the truncated signed distance function (Curless & Levoy 1996; paper, Sec. 3.1).

Each voxel keeps the weighted mean of its distance to the tangent plane at the pixel it projects to,
cut off at the truncation distance (plain projective distances are too long by the slant, which
bends the level set where views differ). Only the foreground's clear pixels move a surface. Other
depth just says that the space in front of it is free, which clears what noise and movement left
behind; near a silhouette it says nothing, for there the true distance is unknown but small.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.tsdf_blocks import TsdfBlocks
from reflest_core.fusion.voxel_key import BLOCK_EDGE, unpack_key
from reflest_core.jit import compiled

FULL_WEIGHT = 16
"""Weight of a surface seen head-on; it falls with the squared cosine of the viewing angle, to 0
beyond 80 degrees, where curvature spoils the distance to the tangent plane."""

MAX_WEIGHT = 256 * FULL_WEIGHT
"""After this the mean slides, so that a moved surface is still followed."""


@compiled
def integrate_blocks(
    depth: NDArray[np.float32],
    slant: NDArray[np.float32],
    free_depth: NDArray[np.float32],
    T: NDArray[np.float64],
    K: NDArray[np.float64],
    voxel_size: float,
    truncation: float,
    blocks: TsdfBlocks,
    count: int,
    frame_number: int,
) -> NDArray[np.int64]:
    """Update every block in sight; return the slots of those that changed, ascending.

    ``T``: (4, 4) world to camera. ``K``: (3, 3). ``truncation``: metres.
    """
    height, width = depth.shape
    fx, fy, cx, cy = K[0, 0], K[1, 1], K[0, 2], K[1, 2]
    radius = 0.5 * math.sqrt(3.0) * (BLOCK_EDGE - 1) * voxel_size
    centre = 0.5 * (BLOCK_EDGE - 1) * voxel_size
    tsdf, weight = blocks.tsdf, blocks.weight
    changed = np.empty(count, np.int64)
    changed_count = 0
    for slot in range(count):
        i, j, k = unpack_key(blocks.keys[slot])
        x0 = i * BLOCK_EDGE * voxel_size
        y0 = j * BLOCK_EDGE * voxel_size
        z0 = k * BLOCK_EDGE * voxel_size
        xm, ym, zm = x0 + centre, y0 + centre, z0 + centre
        zc = T[2, 0] * xm + T[2, 1] * ym + T[2, 2] * zm + T[2, 3]
        if zc + radius <= 0.0:
            continue
        if zc > 2.0 * radius:
            xc = T[0, 0] * xm + T[0, 1] * ym + T[0, 2] * zm + T[0, 3]
            yc = T[1, 0] * xm + T[1, 1] * ym + T[1, 2] * zm + T[1, 3]
            u, v = fx * xc / zc + cx, fy * yc / zc + cy
            reach = 2.0 * max(fx, fy) * radius / (zc - radius)
            if u < -reach or v < -reach or u > width + reach or v > height + reach:
                continue
        has_changed = False
        for a in range(BLOCK_EDGE):
            for b in range(BLOCK_EDGE):
                xw, yw = x0 + a * voxel_size, y0 + b * voxel_size
                xr = T[0, 0] * xw + T[0, 1] * yw + T[0, 2] * z0 + T[0, 3]
                yr = T[1, 0] * xw + T[1, 1] * yw + T[1, 2] * z0 + T[1, 3]
                zr = T[2, 0] * xw + T[2, 1] * yw + T[2, 2] * z0 + T[2, 3]
                for c in range(BLOCK_EDGE):
                    z = zr + c * voxel_size * T[2, 2]
                    if z <= 0.0:
                        continue
                    u = fx * (xr + c * voxel_size * T[0, 2]) / z + cx
                    v = fy * (yr + c * voxel_size * T[1, 2]) / z + cy
                    if not (-0.5 <= u < width - 0.5 and -0.5 <= v < height - 0.5):
                        continue
                    un, vn = int(u + 0.5), int(v + 0.5)
                    value, gain = 1.0, FULL_WEIGHT
                    if slant[vn, un] > 0.0:
                        ahead = _interpolated_depth(depth, u, v, un, vn) - z
                        if ahead < -truncation:
                            continue
                        value = min(1.0, ahead / (truncation * slant[vn, un]))
                        gain = _weight_of(slant[vn, un], (u - cx) / fx, (v - cy) / fy)
                    if value == 1.0:
                        if free_depth[vn, un] - z < truncation:
                            continue
                        gain = FULL_WEIGHT
                    if gain == 0:
                        continue
                    before = int(weight[slot, a, b, c])
                    tsdf[slot, a, b, c] += (value - tsdf[slot, a, b, c]) * gain / (before + gain)
                    weight[slot, a, b, c] = min(before + gain, MAX_WEIGHT)
                    has_changed = True
        if has_changed:
            blocks.last_seen[slot] = frame_number
            changed[changed_count] = slot
            changed_count += 1
    return changed[:changed_count].copy()


@compiled
def _weight_of(slant: float, a: float, b: float) -> int:
    """Weight for a pixel with normalised coordinates (a, b)."""
    return int(FULL_WEIGHT / (slant * slant * (1.0 + a * a + b * b)) + 0.5)


@compiled
def _interpolated_depth(depth: NDArray[np.float32], u: float, v: float, un: int, vn: int) -> float:
    """Bilinear depth at (u, v); (un, vn) is the nearest pixel, clear of depth edges.

    Clear means that its neighbours have depth of the same surface, so that they may be mixed.
    """
    height, width = depth.shape
    u0, v0 = math.floor(u), math.floor(v)
    if u0 < 0 or v0 < 0 or u0 + 1 >= width or v0 + 1 >= height:
        return float(depth[vn, un])
    a, b = u - u0, v - v0
    top = (1.0 - a) * depth[v0, u0] + a * depth[v0, u0 + 1]
    bottom = (1.0 - a) * depth[v0 + 1, u0] + a * depth[v0 + 1, u0 + 1]
    return float((1.0 - b) * top + b * bottom)
