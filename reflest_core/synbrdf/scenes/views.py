# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The cameras of scenes: a VGA depth camera on hand-held orbits, in caps and on full spheres."""

from __future__ import annotations

import enum

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics

FOCAL_LENGTH = 525.0 / 640.0
"""Of the image's width."""


class ViewPattern(enum.Enum):
    """How the views are spread about the object."""

    ORBIT = "orbit"
    """A hand-held walk around (part of) the object, camera above the horizon."""
    CAP = "cap"
    """Scattered within a cone about one direction."""
    SPHERE = "sphere"
    """All over, from below too."""


PATTERN_SHARES = {ViewPattern.ORBIT: 0.5, ViewPattern.CAP: 0.25, ViewPattern.SPHERE: 0.25}


def depth_camera(width: int, height: int) -> CameraIntrinsics:
    """A VGA depth camera's view: the optical axis passes through the middle of the image.

    Args:
        width: Pixels.
        height: Pixels.
    """
    focal = FOCAL_LENGTH * width
    return CameraIntrinsics(width, height, focal, focal, 0.5 * (width - 1), 0.5 * (height - 1))


def look_at(
    centre: NDArray[np.float64], target: NDArray[np.float64], roll: float = 0.0
) -> NDArray[np.float64]:
    """Compute ``T_world_camera`` (4, 4) of an optical frame (z forward, x right, y down).

    Args:
        centre: (3,) camera centre, metres.
        target: (3,) point to look at, metres.
        roll: radians about the optical axis; at 0 world z is up in the image.
    """
    forward = (target - centre) / np.linalg.norm(target - centre)
    up = np.array([0.0, 0.0, 1.0]) if abs(forward[2]) < 0.999 else np.array([1.0, 0.0, 0.0])
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    pose = np.eye(4)
    pose[:3, 0] = np.cos(roll) * right + np.sin(roll) * down
    pose[:3, 1] = np.cos(roll) * down - np.sin(roll) * right
    pose[:3, 2] = forward
    pose[:3, 3] = centre
    return pose


def draw_views(
    rng: np.random.Generator, count: int, object_diameter: float
) -> tuple[NDArray[np.float64], ViewPattern]:
    """Draw camera poses that look at an object at the origin.

    The camera stays 0.5 to 1.5 m away (never nearer than the object's diameter) and aims at a
    point near the object, as a hand does.

    Args:
        rng: random numbers; the same state draws the same.
        count: of poses.
        object_diameter: metres.

    Returns:
        (count, 4, 4) ``T_world_camera``, and how the views are spread.
    """
    patterns = list(PATTERN_SHARES)
    pattern = patterns[rng.choice(len(patterns), p=list(PATTERN_SHARES.values()))]
    directions = _DIRECTIONS[pattern](rng, count)
    nearest = max(0.5, 1.2 * object_diameter)
    mean_distance = rng.uniform(nearest, max(1.5, nearest))
    wander = 1.0 + rng.uniform(0.02, 0.15) * smooth_noise(rng, count)
    distances = np.clip(mean_distance * wander, nearest, 1.6)
    aims = 0.15 * object_diameter * smooth_noise(rng, count, 3)
    rolls = np.deg2rad(6.0) * smooth_noise(rng, count)
    poses = [
        look_at(direction * distance, aim, float(roll))
        for direction, distance, aim, roll in zip(directions, distances, aims, rolls, strict=True)
    ]
    return np.stack(poses), pattern


def smooth_noise(rng: np.random.Generator, count: int, *channels: int) -> NDArray[np.float64]:
    """Draw a slow wander, roughly within [-1, 1]: a sum of sinusoids.

    Args:
        rng: random numbers; the same state draws the same.
        count: steps.
        *channels: further dimensions of the result.
    """
    time = np.linspace(0.0, 1.0, count).reshape(-1, *(1 for _ in channels))
    total = np.zeros((count, *channels))
    for cycles in (1.0, 2.3, 5.1):
        phase = rng.uniform(0.0, 2.0 * np.pi, channels)
        total = total + np.sin(2.0 * np.pi * cycles * time + phase) / cycles
    return np.asarray(total / 1.6)


def _orbit(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    sweep = rng.uniform(np.deg2rad(90.0), np.deg2rad(720.0)) * rng.choice([-1.0, 1.0])
    wander = 0.15 * smooth_noise(rng, count)
    azimuth = rng.uniform(0.0, 2.0 * np.pi) + sweep * np.linspace(0.0, 1.0, count) + wander
    middle, range_ = rng.uniform(15.0, 50.0), rng.uniform(3.0, 25.0)
    elevation = np.deg2rad(np.clip(middle + range_ * smooth_noise(rng, count), 2.0, 80.0))
    return _spherical(azimuth, elevation)


def _cap(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    axis = _spherical(rng.uniform(0.0, 2.0 * np.pi, 1), np.deg2rad(rng.uniform(10.0, 90.0, 1)))[0]
    opening = np.deg2rad(rng.uniform(30.0, 75.0))
    directions = _spherical(
        rng.uniform(0.0, 2.0 * np.pi, count), np.arcsin(rng.uniform(np.cos(opening), 1.0, count))
    )
    return directions @ look_at(np.zeros(3), axis)[:3, :3].T


def _sphere(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    return _spherical(
        rng.uniform(0.0, 2.0 * np.pi, count), np.arcsin(rng.uniform(-1.0, 1.0, count))
    )


def _spherical(azimuth: NDArray[np.float64], elevation: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ],
        axis=1,
    )


_DIRECTIONS = {ViewPattern.ORBIT: _orbit, ViewPattern.CAP: _cap, ViewPattern.SPHERE: _sphere}
