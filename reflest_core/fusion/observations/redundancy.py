# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Frames that show what has been seen from there already.

A frame is known from a view if that stored view lies close to it, and a grid of its surface pixels
finds stored voxels which such a view observed: more than ``KNOWN_SHARE`` of all, and
``KNOWN_SHARE_OF_TILE`` in each tile of the image, so that a small thing that came or went is
noticed. Of frames known from a view, those that show ``WELL_KNOWN_SHARE`` bring their depth alone,
and once enough frames were fused near the view, any is redundant: it changes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames.foreground import FramePixels
from reflest_core.fusion.observations.observation_chunks import ObservationChunks
from reflest_core.fusion.observations.observation_queries import has_seen
from reflest_core.fusion.observations.observation_rows import ObservationRows
from reflest_core.fusion.observations.observation_store import ObservationStore, marked
from reflest_core.fusion.observations.views import ViewTable
from reflest_core.jit import compiled, kernel_array
from reflest_core.surface.key_index import find_row
from reflest_core.surface.voxel_key import VOXEL_LIMIT, pack_key

KNOWN_SHARE = 0.8
KNOWN_SHARE_OF_TILE = 0.5
WELL_KNOWN_SHARE = 0.95

SAMPLES_ACROSS = 64
"""Pixels of the grid along an image's width."""

TILE = 8
"""Grid pixels along a tile's edge."""


@dataclass(frozen=True)
class KnownFrame:
    """A frame that shows what stored views showed already.

    Attributes:
        view: The nearest stored view.
        share: Share of the frame's surface that views like it observed.
    """

    view: int
    share: float


def known_frame(
    frame: Frame,
    pixels: FramePixels,
    store: ObservationStore,
    views: ViewTable,
    voxel_size: float,
    view_spacing: float,
) -> KnownFrame | None:
    """Find the view from which a frame is known.

    Args:
        frame: The frame.
        pixels: What fusion takes of it.
        store: The stored observations.
        views: The stored views.
        voxel_size: Metres.
        view_spacing: Degrees between views that are distinct.

    Returns:
        The view, or None where the frame is not known.
    """
    T = kernel_array(frame.T_world_camera, np.float64)
    K = frame.intrinsics.matrix
    stride = max(1, pixels.depth.shape[1] // SAMPLES_ACROSS)
    points = _surface_grid(pixels.depth, pixels.surface, stride, T, K)
    is_sample = np.isfinite(points[..., 0])
    if not is_sample.any():
        return None
    near = views.near(frame.camera_centre, points[is_sample].mean(axis=0), view_spacing)
    if len(near) == 0:
        return None
    is_known = _seen_voxels(points, voxel_size, store.rows, store.pool.chunks, marked(near))
    known, samples = _count_by_tile(is_known), _count_by_tile(is_sample)
    share = float(known.sum() / samples.sum())
    if share < KNOWN_SHARE or np.any(known < KNOWN_SHARE_OF_TILE * samples):
        return None
    return KnownFrame(int(near[0]), share)


def _count_by_tile(grid: NDArray[np.bool_]) -> NDArray[np.int64]:
    rows = np.add.reduceat(grid, np.arange(0, grid.shape[0], TILE), axis=0, dtype=np.int64)
    return np.add.reduceat(rows, np.arange(0, grid.shape[1], TILE), axis=1)


@compiled
def _surface_grid(
    depth: NDArray[np.float32],
    surface: NDArray[np.bool_],
    stride: int,
    T: NDArray[np.float64],
    K: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(H / stride, W / stride, 3) points in the world frame, NaN off the surface."""
    height, width = depth.shape[0] // stride, depth.shape[1] // stride
    points = np.full((height, width, 3), np.nan)
    for row in range(height):
        for column in range(width):
            v, u = row * stride + stride // 2, column * stride + stride // 2
            if surface[v, u]:
                z = float(depth[v, u])
                x, y = (u - K[0, 2]) / K[0, 0] * z, (v - K[1, 2]) / K[1, 1] * z
                for axis in range(3):
                    points[row, column, axis] = (
                        T[axis, 0] * x + T[axis, 1] * y + T[axis, 2] * z + T[axis, 3]
                    )
    return points


@compiled
def _seen_voxels(
    points: NDArray[np.float64],
    voxel_size: float,
    rows: ObservationRows,
    chunks: ObservationChunks,
    is_one: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """True where a voxel around the point, at most one away, was observed by one of the views."""
    height, width, _ = points.shape
    seen = np.zeros((height, width), np.bool_)
    for row in range(height):
        for column in range(width):
            x, y, z = points[row, column] / voxel_size
            if not max(abs(x), abs(y), abs(z)) < VOXEL_LIMIT - 2:
                continue
            i, j, k = int(np.rint(x)), int(np.rint(y)), int(np.rint(z))
            for n in range(27):
                # From the middle one, n = 13, outwards: 13, 14, 12, 15, 11, ...
                m = 13 + (n + 1) // 2 * (1 if n % 2 else -1)
                key = pack_key(i + m // 9 - 1, j + m // 3 % 3 - 1, k + m % 3 - 1)
                found = find_row(rows.index_keys, rows.index_rows, key)
                if found >= 0 and has_seen(rows, chunks, found, is_one):
                    seen[row, column] = True
                    break
    return seen
