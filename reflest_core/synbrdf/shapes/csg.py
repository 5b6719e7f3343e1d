# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Constructive solids: unions of primitives, some of them cut away."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from reflest_core.synbrdf.shapes.implicit import EmptyShape, Field, mesh_of
from reflest_core.synbrdf.shapes.mesh import FloatArray, TriangleMesh

RESOLUTION = 72


def draw_csg(rng: np.random.Generator) -> TriangleMesh:
    """Draw 2 to 6 primitives that overlap; the last is cut away from one solid in three.

    Args:
        rng: random numbers; the same state draws the same.
    """
    while True:
        parts = [_primitive(rng) for _ in range(int(rng.integers(2, 7)))]
        blend = rng.uniform(0.005, 0.15)
        cut = _primitive(rng) if rng.uniform() < 0.33 else None
        try:
            return mesh_of(_union(parts, blend, cut), RESOLUTION)
        except EmptyShape:
            continue


def _union(parts: list[Field], blend: float, cut: Field | None) -> Field:
    def field(points: FloatArray) -> FloatArray:
        # The soft minimum rounds the seam over about ``blend``.
        distances = np.stack([part(points) for part in parts])
        nearest = distances.min(axis=0)
        closeness: FloatArray = np.exp((nearest - distances) / blend).sum(axis=0)
        solid: FloatArray = nearest - blend * np.log(closeness)
        return solid if cut is None else np.maximum(solid, -cut(points))

    return field


def _primitive(rng: np.random.Generator) -> Field:
    kind = _PRIMITIVES[int(rng.integers(len(_PRIMITIVES)))]
    distance = kind(rng)
    rotation = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    centre = rng.uniform(-0.45, 0.45, 3)
    return lambda points: distance((points - centre) @ rotation)


def _ball(rng: np.random.Generator) -> Field:
    radius = rng.uniform(0.25, 0.6)
    return lambda p: np.linalg.norm(p, axis=-1) - radius


def _box(rng: np.random.Generator) -> Field:
    half_edges, rounding = rng.uniform(0.15, 0.55, 3), rng.uniform(0.01, 0.1)

    def distance(points: FloatArray) -> FloatArray:
        beyond = np.abs(points) - half_edges
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        return np.asarray(outside + np.minimum(beyond.max(axis=-1), 0.0) - rounding)

    return distance


def _cylinder(rng: np.random.Generator) -> Field:
    radius, half_height = rng.uniform(0.12, 0.45), rng.uniform(0.2, 0.75)

    def distance(points: FloatArray) -> FloatArray:
        beyond = np.stack(
            [
                np.linalg.norm(points[..., :2], axis=-1) - radius,
                np.abs(points[..., 2]) - half_height,
            ]
        )
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=0)
        return np.asarray(outside + np.minimum(beyond.max(axis=0), 0.0) - 0.02)

    return distance


def _torus(rng: np.random.Generator) -> Field:
    ring, tube = rng.uniform(0.3, 0.6), rng.uniform(0.1, 0.25)

    def distance(points: FloatArray) -> FloatArray:
        from_ring = np.linalg.norm(points[..., :2], axis=-1) - ring
        return np.asarray(np.hypot(from_ring, points[..., 2]) - tube)

    return distance


_PRIMITIVES: tuple[Callable[[np.random.Generator], Field], ...] = (_ball, _box, _cylinder, _torus)
