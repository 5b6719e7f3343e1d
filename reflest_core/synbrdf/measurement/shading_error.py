# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How far the shading normals of procedural shapes are from those of their triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.shapes.mesh import TriangleMesh
from reflest_core.synbrdf.shapes.procedural import KINDS


def shading_error(mesh: TriangleMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Degrees (F,) between each triangle's normal and its mean shading normal; areas (F,).

    Args:
        mesh: the shape.
    """
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    flat = np.cross(b - a, c - a)
    shaded = mesh.normals[mesh.faces].sum(axis=1)
    lengths = np.linalg.norm(flat, axis=1) * np.linalg.norm(shaded, axis=1)
    cosine = np.einsum("ij,ij->i", flat, shaded) / np.maximum(lengths, 1e-300)
    return np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0))), mesh.face_areas


def poor_share(kind: str, seeds: range, degrees: float) -> float:
    """Measure the share of a shape's area whose shading normal is far from its triangle's.

    Args:
        kind: of procedural shape.
        seeds: of shapes.
        degrees: angle beyond which a normal is poor.
    """
    shares = []
    for seed in seeds:
        error, areas = shading_error(KINDS[kind](np.random.default_rng(seed)))
        shares.append(areas[error > degrees].sum() / areas.sum())
    return float(np.mean(shares))
