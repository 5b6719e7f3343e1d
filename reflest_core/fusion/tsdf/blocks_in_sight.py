# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Blocks that may appear in an image without being near the surface that it shows."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.voxel_key import BLOCK_EDGE, unpack_key


@compiled
def blocks_in_sight(
    first: int,
    most: int,
    keys: NDArray[np.int64],
    last_seen: NDArray[np.int64],
    frame_number: int,
    P: NDArray[np.float64],
    voxel_size: float,
    width: int,
    height: int,
    reach: float,
) -> NDArray[np.int64]:
    """Slots, of the ``most`` from ``first`` on, that may project into the image.

    Going round at the end; blocks already marked as seen in ``frame_number`` are left out. ``P``:
    (3, 4), world to homogeneous pixels. ``reach``: metres of depth beyond which none is wanted.
    """
    count = len(keys)
    radius = 0.5 * math.sqrt(3.0) * (BLOCK_EDGE - 1) * voxel_size
    centre = 0.5 * (BLOCK_EDGE - 1) * voxel_size
    edge = BLOCK_EDGE * voxel_size
    steepest_u = math.sqrt(P[0, 0] ** 2 + P[0, 1] ** 2 + P[0, 2] ** 2)
    steepest_v = math.sqrt(P[1, 0] ** 2 + P[1, 1] ** 2 + P[1, 2] ** 2)
    found = np.empty(min(count, most), np.int64)
    found_count = 0
    for n in range(len(found)):
        slot = (first + n) % count
        if last_seen[slot] == frame_number:
            continue
        i, j, k = unpack_key(keys[slot])
        x, y, z = i * edge + centre, j * edge + centre, k * edge + centre
        ahead = P[2, 0] * x + P[2, 1] * y + P[2, 2] * z + P[2, 3]
        if ahead + radius <= 0.0 or ahead - radius > reach:
            continue
        # A pixel row or column is a plane through the camera: compare distances to the image's.
        u = P[0, 0] * x + P[0, 1] * y + P[0, 2] * z + P[0, 3]
        v = P[1, 0] * x + P[1, 1] * y + P[1, 2] * z + P[1, 3]
        across, down = (steepest_u + width) * radius, (steepest_v + height) * radius
        if u < -across or v < -down or u > width * ahead + across or v > height * ahead + down:
            continue
        found[found_count] = slot
        found_count += 1
    return found[:found_count].copy()
