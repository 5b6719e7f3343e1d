# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Objects that materials are rendered on: a smooth and a bumpy sphere, seen along +y from afar."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

SIZE = 64
"""Pixels on each side of a picture."""
FRAME = 1.12
"""Half the width of the picture, in units of the sphere's radius."""
BUMPS = ((5.0, 0.3, 0.07), (8.0, 1.9, 0.04), (13.0, 4.1, 0.02))
"""Spatial frequency, phase and height of the bumps."""


@dataclass(frozen=True)
class Shape:
    """The object's pixels and their normals.

    Attributes:
        name: ``sphere`` or ``bumpy``.
        inside: (SIZE, SIZE) bool, pixels of the object.
        normals: (P, 3) float64, unit, of these pixels in row-major order; x right, z up.
    """

    name: str
    inside: NDArray[np.bool_]
    normals: NDArray[np.float64]


def sphere() -> Shape:
    """A smooth sphere of radius 1."""
    return _orthographic("sphere", height=0.0)


def bumpy_sphere() -> Shape:
    """A sphere with bumps and dents in many directions; it casts no shadow on itself."""
    return _orthographic("bumpy", height=1.0)


def _orthographic(name: str, height: float) -> Shape:
    across = ((np.arange(SIZE) + 0.5) * 2 / SIZE - 1) * FRAME
    x, z = np.meshgrid(across, -across)
    points = np.stack([x, np.full_like(x, -1.3), z], axis=-1).reshape(-1, 3)
    # Sphere tracing along +y with steps short enough for the bumps.
    for _ in range(120):
        points[:, 1] += 0.6 * np.clip(_distance(points, height), 0, None)
    inside = np.abs(_distance(points, height)) < 2e-3
    hits = points[inside]
    step = 1e-4
    gradient = np.stack(
        [_distance(hits + step * axis, height) - _distance(hits, height) for axis in np.eye(3)],
        axis=-1,
    )
    normals = gradient / np.linalg.norm(gradient, axis=-1, keepdims=True)
    facing = normals[:, 1] < -0.02
    mask = np.zeros(SIZE * SIZE, np.uint8)
    mask[np.flatnonzero(inside)[facing]] = 1
    # Rays that graze a bump leave lone pixels beside the silhouette.
    whole = cv2.morphologyEx(mask.reshape(SIZE, SIZE), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    kept = whole.astype(np.bool_)
    return Shape(name, kept, normals[kept.reshape(-1)[inside]])


def _distance(points: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Signed distance (P,), nearly, to the surface ``|p| = 1 + bumps``."""
    radius = np.linalg.norm(points, axis=-1)
    unit = points / np.maximum(radius, 1e-9)[:, None]
    bumps = np.zeros(len(points))
    for frequency, phase, amplitude in BUMPS:
        waves = np.sin(frequency * unit + phase * np.array([1.0, 1.7, 2.3]))
        bumps += amplitude * waves.prod(axis=-1)
    signed: NDArray[np.float64] = radius - 1 - height * bumps
    return signed
