# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Procedural shapes without end: every generator state gives another."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from reflest_core.synbrdf.shapes.blob import draw_blob
from reflest_core.synbrdf.shapes.csg import draw_csg
from reflest_core.synbrdf.shapes.lathe import draw_lathe
from reflest_core.synbrdf.shapes.mesh import FloatArray, TriangleMesh
from reflest_core.synbrdf.shapes.superquadric import draw_superquadric
from reflest_core.synbrdf.shapes.sweep import draw_sweep

KINDS: dict[str, Callable[[np.random.Generator], TriangleMesh]] = {
    "blob": draw_blob,
    "superquadric": draw_superquadric,
    "lathe": draw_lathe,
    "sweep": draw_sweep,
    "csg": draw_csg,
}
DIAMETERS = (0.15, 0.5)
"""Metres."""


def draw_procedural(rng: np.random.Generator, kind: str | None = None) -> tuple[TriangleMesh, str]:
    """Draw a shape, unplaced.

    Args:
        rng: random numbers; the same state draws the same.
        kind: of shape; None draws one.

    Returns:
        The mesh and its kind.
    """
    chosen = kind or list(KINDS)[int(rng.integers(len(KINDS)))]
    return KINDS[chosen](rng), chosen


def draw_rotation(rng: np.random.Generator, upright: bool) -> FloatArray:
    """Draw a rotation (3, 3): about the vertical only, or any.

    Args:
        rng: random numbers; the same state draws the same.
        upright: turn about the vertical alone.
    """
    if upright:
        matrix = Rotation.from_euler("z", rng.uniform(0.0, 2.0 * np.pi)).as_matrix()
    else:
        matrix = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    return np.asarray(matrix)
