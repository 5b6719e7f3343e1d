# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A sphere on a table, ray-cast in numpy: the capture that the node's tests send."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

WIDTH, HEIGHT, FOCAL = 160, 120, 140.0
RADIUS = 0.12
CENTRE = np.array([0.0, 0.0, RADIUS])
PERIOD_NS = 33_333_333
FIRST_STAMP_NS = 100_000_000_000


@dataclass(frozen=True)
class View:
    """One frame of the scene: 8-bit colour, depth in metres, the camera's pose."""

    stamp_ns: int
    rgb: np.ndarray
    depth: np.ndarray
    T_world_camera: np.ndarray


def views(count: int = 24) -> Iterator[View]:
    """A camera that moves in an arc around the sphere, 0.6 m away."""
    for index in range(count):
        angle = 1.8 * math.pi * index / count
        elevation = 0.7 + 0.3 * math.sin(3 * angle)
        eye = CENTRE + 0.6 * np.array(
            [
                math.cos(angle) * math.cos(elevation),
                math.sin(angle) * math.cos(elevation),
                math.sin(elevation),
            ]
        )
        pose = _looking_at(eye, CENTRE)
        rgb, depth = _render(pose)
        yield View(FIRST_STAMP_NS + index * PERIOD_NS, rgb, depth, pose)


def _looking_at(eye: np.ndarray, target: np.ndarray) -> np.ndarray:
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    pose[:3, 3] = eye
    return pose


def _render(pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    columns, rows = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    rays = np.stack(
        [(columns - WIDTH / 2) / FOCAL, (rows - HEIGHT / 2) / FOCAL, np.ones(columns.shape)],
        axis=-1,
    )
    directions = rays @ pose[:3, :3].T
    eye = pose[:3, 3]
    plane = np.where(directions[..., 2] < -1e-6, -eye[2] / directions[..., 2], np.inf)
    sphere = _sphere_distance(eye, directions)
    depth = np.minimum(plane, sphere)
    points = eye + depth[..., None] * directions
    normals = np.where((sphere <= plane)[..., None], (points - CENTRE) / RADIUS, [0.0, 0.0, 1.0])
    light = np.array([0.4, 0.3, 0.866])
    shade = 0.15 + 0.85 * np.clip(normals @ light, 0, 1)
    to_eye = -directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    half = to_eye + light
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    gloss = 0.5 * np.clip((half * normals).sum(-1), 0, 1) ** 40
    albedo = np.where((sphere <= plane)[..., None], [0.6, 0.2, 0.15], [0.5, 0.5, 0.45])
    colour = np.clip(albedo * shade[..., None] + gloss[..., None], 0, 1)
    valid = np.isfinite(depth) & (depth < 3.0)
    rgb = np.where(valid[..., None], 255 * colour ** (1 / 2.2), 90).astype(np.uint8)
    return rgb, np.where(valid, depth, 0.0).astype(np.float32)


def _sphere_distance(eye: np.ndarray, directions: np.ndarray) -> np.ndarray:
    offset = eye - CENTRE
    a = (directions**2).sum(-1)
    b = directions @ offset
    root = b**2 - a * (offset @ offset - RADIUS**2)
    return np.where(root >= 0, (-b - np.sqrt(np.maximum(root, 0))) / a, np.inf)
