# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Turned forms: vases, knobs, pawns."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from reflest_core.synbrdf.shapes.mesh import (
    TriangleMesh,
    facing_outwards,
    grid_faces,
    with_crease_normals,
)

STEPS, COLUMNS = 90, 120


def draw_lathe(rng: np.random.Generator) -> TriangleMesh:
    """Draw a profile of 4 to 8 radii (smooth, or with sharp rings) and turn it about z.

    Flutes run up one turned form in three.

    Args:
        rng: random numbers; the same state draws the same.
    """
    knots = int(rng.integers(4, 9))
    heights = np.sort(rng.uniform(0.0, 1.0, knots))
    heights = 0.5 * heights + 0.5 * np.linspace(0.0, 1.0, knots)
    heights = (heights - heights[0]) / (heights[-1] - heights[0])
    radii = rng.uniform(0.15, 0.7, knots)
    along = np.linspace(0.0, 1.0, STEPS)
    if rng.uniform() < 0.6:
        profile = PchipInterpolator(heights, radii)(along)
    else:
        profile = np.interp(along, heights, radii)
    height = rng.uniform(0.8, 2.0)
    # The axis closes the form at both ends.
    radius = np.concatenate([[1e-4], profile, [1e-4]])[:, None]
    level = height * np.concatenate([[0.0], along, [1.0]])[:, None]
    angle = np.linspace(0.0, 2.0 * np.pi, COLUMNS, endpoint=False)[None, :]
    if rng.uniform() < 0.33:
        radius = radius * (1.0 + rng.uniform(0.02, 0.1) * np.cos(rng.integers(3, 13) * angle))
    vertices = np.stack(
        np.broadcast_arrays(radius * np.cos(angle), radius * np.sin(angle), level), axis=-1
    ).reshape(-1, 3)
    faces = grid_faces(STEPS + 2, COLUMNS, False, True)
    return with_crease_normals(vertices, facing_outwards(vertices, faces))
