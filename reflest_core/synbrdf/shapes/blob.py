# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Metaballs: a smooth blob from a handful of Gaussian bumps."""

from __future__ import annotations

import numpy as np

from reflest_core.synbrdf.shapes.implicit import mesh_of
from reflest_core.synbrdf.shapes.mesh import FloatArray, TriangleMesh


def draw_blob(rng: np.random.Generator) -> TriangleMesh:
    """Draw 2 to 8 bumps that overlap, each flattened a little in its own direction.

    Args:
        rng: random numbers; the same state draws the same.
    """
    count = int(rng.integers(2, 9))
    centres = rng.normal(size=(count, 3))
    centres *= rng.uniform(0.1, 0.75, (count, 1)) / np.linalg.norm(centres, axis=1, keepdims=True)
    stretches = rng.uniform(0.75, 1.6, (count, 3)) / rng.uniform(0.3, 0.55, (count, 1))

    def field(points: FloatArray) -> FloatArray:
        density = np.zeros(points.shape[:-1])
        for centre, stretch in zip(centres, stretches, strict=True):
            density += np.exp(-np.sum(((points - centre) * stretch) ** 2, axis=-1))
        # The logarithm makes the field about as steep everywhere on the surface.
        return np.asarray(-np.log(np.maximum(density, 1e-30)) - 0.8)

    return mesh_of(field)
