# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Spheres of several radii on a table, with exact normals: surfaces of known curvature."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.scene.renderer import camera_of
from reflest_core.capture.frame import Frame
from reflest_core.synbrdf.scenes.views import look_at

RADII = (0.12, 0.06, 0.03, 0.015)
"""Metres."""
PLACES = ((-0.16, 0.12), (0.14, 0.14), (0.12, -0.12), (-0.08, -0.16))
"""x and y of the spheres' centres, metres."""
TABLE = 0.45
"""Half the edge of the square table at z = 0, metres."""
DISTANCE = 0.6
"""Metres from the cameras to the middle of the scene."""
GRAZING = 0.12
"""Cosine of the angle of incidence below which there is no depth."""
CORRELATION = 1.5
"""Standard deviation, in pixels, of the blur that correlates noise in space."""


@dataclass(frozen=True)
class Noise:
    """Errors of a depth camera; a structured-light sensor's grow with the square of the depth.

    Attributes:
        name: As it is printed.
        scale: Of the standard deviation, which is 1.2 mm at 0.4 m and 1.9 mm more for each square
            metre beyond; 0 for exact depth.
        is_correlated: Whether neighbouring pixels err alike.
    """

    name: str
    scale: float
    is_correlated: bool = False

    def added(self, depth: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float32]:
        """Add noise and round to millimetres.

        Args:
            depth: (H, W) metres, 0 unknown.
            rng: Draws the errors.

        Returns:
            (H, W) metres.
        """
        if self.scale == 0.0:
            return depth.astype(np.float32)
        error = rng.normal(size=depth.shape)
        if self.is_correlated:
            blurred = np.asarray(cv2.GaussianBlur(error, (0, 0), CORRELATION), np.float64)
            error = blurred / blurred.std()
        sigma = self.scale * (0.0012 + 0.0019 * (depth - 0.4) ** 2)
        noisy = np.rint((depth + sigma * error) * 1000.0) / 1000.0
        return np.where(depth > 0.0, noisy, 0.0).astype(np.float32)


def sphere_frames(count: int, noise: Noise, seed: int = 1) -> Iterator[Frame]:
    """Film the scene from around it, 25 to 60 degrees above the table.

    Args:
        count: Number of frames.
        noise: Of the depth.
        seed: Of the noise.

    Yields:
        VGA frames of one colour.
    """
    camera = camera_of(640, 480)
    rng = np.random.default_rng(seed)
    rgb = np.full((camera.height, camera.width, 3), 128, np.uint8)
    v, u = np.mgrid[: camera.height, : camera.width].astype(np.float64)
    rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones_like(u)], -1)
    for number in range(count):
        turn = 2.0 * math.pi * number / count
        height = math.radians(42.5 + 17.5 * math.sin(3.0 * turn))
        around = np.array([math.cos(turn) * math.cos(height), math.sin(turn) * math.cos(height)])
        pose = look_at(DISTANCE * np.array([*around, math.sin(height)]), np.zeros(3))
        depth = _depth(pose[:3, 3], rays @ pose[:3, :3].T)
        yield Frame((number + 1) * 33_000_000, rgb, noise.added(depth, rng), pose, camera)


def surface_of(positions: NDArray[np.floating]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Say which surface points lie on, and its exact normals there.

    Args:
        positions: (N, 3) near the scene's surfaces, metres.

    Returns:
        (N,) index into :data:`RADII`, or ``len(RADII)`` for the table; (N, 3) unit normals.
    """
    offsets = [positions - _centre(index) for index in range(len(RADII))]
    away = [np.linalg.norm(offset, axis=1) for offset in offsets]
    gaps = [np.abs(d - radius) for d, radius in zip(away, RADII, strict=True)]
    owner = np.argmin([*gaps, np.abs(positions[:, 2])], axis=0)
    normals = np.tile([0.0, 0.0, 1.0], (len(positions), 1))
    for index, (offset, distance) in enumerate(zip(offsets, away, strict=True)):
        normals[owner == index] = (offset / distance[:, None])[owner == index]
    return owner, normals


def rim_distance(positions: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return how far points are from where a sphere meets the table, and from the table's edge.

    Args:
        positions: (N, 3) metres.

    Returns:
        (N,) metres.
    """
    contacts = [np.linalg.norm(positions - np.array([x, y, 0.0]), axis=1) for x, y in PLACES]
    edge = TABLE - np.abs(positions[:, :2]).max(axis=1)
    return np.asarray(np.minimum(np.min(contacts, axis=0), np.abs(edge)))


def _centre(index: int) -> NDArray[np.float64]:
    return np.array([*PLACES[index], RADII[index]])


def _depth(origin: NDArray[np.float64], rays: NDArray[np.float64]) -> NDArray[np.float64]:
    """(H, W) depth of what rays (H, W, 3) of unit depth meet first; 0 for nothing."""
    depth = np.full(rays.shape[:2], np.inf)
    cosine = np.zeros(rays.shape[:2])
    lengths = np.linalg.norm(rays, axis=-1)
    for index, radius in enumerate(RADII):
        offset = origin - _centre(index)
        a, b = np.sum(rays**2, -1), rays @ offset
        square = b**2 - a * (offset @ offset - radius**2)
        z = (-b - np.sqrt(np.maximum(square, 0.0))) / a
        is_hit = (square > 0.0) & (z > 0.0) & (z < depth)
        depth[is_hit] = z[is_hit]
        normal: NDArray[np.float64] = (offset + z[..., None] * rays) / radius
        cosine[is_hit] = -(np.sum(normal * rays, -1) / lengths)[is_hit]
    z = -origin[2] / rays[..., 2]
    x, y = origin[0] + z * rays[..., 0], origin[1] + z * rays[..., 1]
    is_table = (z > 0.0) & (z < depth) & (np.maximum(np.abs(x), np.abs(y)) < TABLE)
    depth[is_table] = z[is_table]
    cosine[is_table] = (-rays[..., 2] / lengths)[is_table]
    found: NDArray[np.float64] = np.where(np.isfinite(depth) & (cosine > GRAZING), depth, 0.0)
    return found
