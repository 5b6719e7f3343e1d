# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Superquadrics with a bumpy skin."""

from __future__ import annotations

import numpy as np

from reflest_core.synbrdf.shapes.mesh import (
    FloatArray,
    TriangleMesh,
    facing_outwards,
    grid_faces,
    with_crease_normals,
)

ROWS, COLUMNS = 72, 120


def draw_superquadric(rng: np.random.Generator) -> TriangleMesh:
    """Draw a superellipsoid (from pillow to box to diamond) displaced along its radius.

    Args:
        rng: random numbers; the same state draws the same.
    """
    squareness = rng.uniform(0.25, 1.7, 2)
    axes = rng.uniform(0.5, 1.0, 3)
    latitude = np.linspace(-0.5 * np.pi + 1e-3, 0.5 * np.pi - 1e-3, ROWS)[:, None]
    longitude = np.linspace(0.0, 2.0 * np.pi, COLUMNS, endpoint=False)[None, :]
    ring = _power(np.cos(latitude), squareness[0])
    points = np.stack(
        np.broadcast_arrays(
            axes[0] * ring * _power(np.cos(longitude), squareness[1]),
            axes[1] * ring * _power(np.sin(longitude), squareness[1]),
            axes[2] * _power(np.sin(latitude), squareness[0]),
        ),
        axis=-1,
    ).reshape(-1, 3)
    points = points * (1.0 + _bumps(rng, points))[:, None]
    poles = np.stack([points[:COLUMNS].mean(axis=0), points[-COLUMNS:].mean(axis=0)])
    vertices = np.concatenate([points, poles])
    faces = np.concatenate([grid_faces(ROWS, COLUMNS, False, True), *_caps(len(points))])
    return with_crease_normals(vertices, facing_outwards(vertices, faces))


def _power(base: FloatArray, exponent: float) -> FloatArray:
    """Signed power, as superquadrics use it."""
    return np.asarray(np.sign(base) * np.abs(base) ** exponent)


def _bumps(rng: np.random.Generator, points: FloatArray) -> FloatArray:
    """Relative displacement (N,): a few waves through space, none at all for one shape in four."""
    strength = 0.0 if rng.uniform() < 0.25 else rng.uniform(0.01, 0.12)
    total = np.zeros(len(points))
    for _ in range(int(rng.integers(2, 7))):
        wave = rng.normal(size=3)
        wave *= rng.uniform(2.0, 10.0) / np.linalg.norm(wave)
        total += np.sin(points @ wave + rng.uniform(0.0, 2.0 * np.pi)) / np.linalg.norm(wave)
    return strength * total * 2.0


def _caps(pole: int) -> list[FloatArray]:
    """Fans that close the grid at its first and last row."""
    column = np.arange(COLUMNS)
    following = (column + 1) % COLUMNS
    last = (ROWS - 1) * COLUMNS
    south = np.stack([np.full(COLUMNS, pole), following, column], axis=1)
    north = np.stack([np.full(COLUMNS, pole + 1), last + column, last + following], axis=1)
    # grid_faces winds rows before columns; the fans must wind the same way.
    return [south[:, ::-1], north[:, ::-1]]
