# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Swept forms: a closed tube along a smooth curve in space."""

from __future__ import annotations

import numpy as np

from reflest_core.synbrdf.shapes.mesh import (
    FloatArray,
    TriangleMesh,
    facing_outwards,
    grid_faces,
    with_crease_normals,
)

STEPS, COLUMNS = 200, 40


def draw_sweep(rng: np.random.Generator) -> TriangleMesh:
    """Draw a closed curve of low frequency and sweep a section of changing radius along it.

    Args:
        rng: random numbers; the same state draws the same.
    """
    time = np.linspace(0.0, 2.0 * np.pi, STEPS, endpoint=False)
    path = np.stack([np.cos(time), np.sin(time), np.zeros(STEPS)], axis=1)
    for cycles in (2, 3):
        amplitude = rng.uniform(0.0, 0.45, 3) / (cycles - 1)
        phase = rng.uniform(0.0, 2.0 * np.pi, 3)
        path += amplitude * np.sin(cycles * time[:, None] + phase)
    radius = rng.uniform(0.12, 0.4) * (
        1.0 + rng.uniform(0.0, 0.4) * np.sin(int(rng.integers(1, 6)) * time + rng.uniform(0.0, 6.0))
    )
    lobes, lobe_depth = int(rng.integers(2, 6)), rng.uniform(0.0, 0.35)
    angle = np.linspace(0.0, 2.0 * np.pi, COLUMNS, endpoint=False)
    section = 1.0 + lobe_depth * np.cos(lobes * angle)
    normal, binormal = _rotation_minimising_frame(path)
    ring = (np.cos(angle) * section)[None, :, None] * normal[:, None]
    ring = ring + (np.sin(angle) * section)[None, :, None] * binormal[:, None]
    vertices = (path[:, None] + radius[:, None, None] * ring).reshape(-1, 3)
    faces = grid_faces(STEPS, COLUMNS, True, True)
    return with_crease_normals(vertices, facing_outwards(vertices, faces))


def _rotation_minimising_frame(path: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two unit normals (N, 3) of a closed path that do not spin about it and meet at its end."""
    tangent = np.roll(path, -1, axis=0) - np.roll(path, 1, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    normal = np.empty_like(path)
    seed = np.eye(3)[np.abs(tangent[0]).argmin()]
    carried = seed
    for step in range(len(path)):
        carried = carried - tangent[step] * (carried @ tangent[step])
        carried = carried / np.linalg.norm(carried)
        normal[step] = carried
    binormal = np.cross(tangent, normal)
    closing = carried - tangent[0] * (carried @ tangent[0])
    twist = np.arctan2(closing @ binormal[0], closing @ normal[0])
    # Spread the angle by which the carried frame misses its start evenly along the path.
    angle = -twist * np.linspace(0.0, 1.0, len(path))[:, None]
    return (
        np.cos(angle) * normal + np.sin(angle) * binormal,
        np.cos(angle) * binormal - np.sin(angle) * normal,
    )
