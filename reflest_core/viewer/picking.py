# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What lies under a click."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.viewer.shown_scan import ShownScan

PARALLEL = 1e-12
"""Of a determinant below which a ray runs along a triangle."""


def vertex_under(
    scan: ShownScan, origin: NDArray[np.floating], direction: NDArray[np.floating]
) -> tuple[int, NDArray[np.float64]] | None:
    """Find where a ray first meets the surface (Moeller and Trumbore 1997).

    Args:
        scan: what is shown.
        origin: (3,) world frame, metres.
        direction: (3,) any length but 0.

    Returns:
        The nearest vertex there and the (3,) point; None where the ray meets nothing.
    """
    origin, direction = np.asarray(origin, np.float64), np.asarray(direction, np.float64)
    corner, second, third = (scan.vertices[scan.faces[:, k]].astype(np.float64) for k in range(3))
    edge, other = second - corner, third - corner
    across = np.cross(direction, other)
    determinant = np.einsum("fc,fc->f", edge, across)
    is_flat = np.abs(determinant) < PARALLEL
    scale = 1.0 / np.where(is_flat, 1.0, determinant)
    away = origin - corner
    u = np.einsum("fc,fc->f", away, across) * scale
    turned = np.cross(away, edge)
    v = turned @ direction * scale
    distance = np.einsum("fc,fc->f", other, turned) * scale
    is_hit = ~is_flat & (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 0)
    if not is_hit.any():
        return None
    face = int(np.argmin(np.where(is_hit, distance, np.inf)))
    point = origin + distance[face] * direction
    corners = scan.faces[face]
    nearest = np.linalg.norm(scan.vertices[corners] - point, axis=1).argmin()
    return int(corners[nearest]), point
