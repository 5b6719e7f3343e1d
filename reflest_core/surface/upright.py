# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Rotations that keep to the vertical, and worlds turned so that they have z up."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reflest_core.light.turned_light import turned_light
from reflest_core.surface.observed_surface import ObservedSurface


def upright(surface: ObservedSurface, up: tuple[float, float, float]) -> ObservedSurface:
    """Turn surface, cameras and light the shortest way that takes a direction to +z.

    Args:
        surface: in a world of any orientation.
        up: direction in that world that points up, not zero.
    """
    if up == (0.0, 0.0, 1.0):
        return surface
    rotation = rotation_to_z(up).astype(np.float32)
    return dataclasses.replace(
        surface,
        positions=surface.positions @ rotation.T,
        normals=surface.normals @ rotation.T,
        view_centres=surface.view_centres @ rotation.T,
        light=None if surface.light is None else turned_light(surface.light, rotation),
    )


def rotation_to_z(direction: ArrayLike) -> NDArray[np.float64]:
    """The shortest rotation that takes a direction to +z.

    Args:
        direction: (3,) of any length but 0.

    Returns:
        (3, 3) rotation, made of two reflections, which hold for any direction.
    """
    up = np.asarray(direction, np.float64) / np.linalg.norm(direction)
    z = np.array([0.0, 0.0, 1.0])
    if up[2] < -0.999999:
        return np.diag([1.0, -1.0, -1.0])
    middle = (up + z) / np.linalg.norm(up + z)
    reflect_middle = 2 * np.outer(middle, middle) - np.eye(3)
    reflect_up = 2 * np.outer(up, up) - np.eye(3)
    rotation: NDArray[np.float64] = reflect_middle @ reflect_up
    return rotation


def rotation_about_z(angle: float) -> NDArray[np.float64]:
    """The rotation about the vertical.

    Args:
        angle: radians, counterclockwise from above.

    Returns:
        (3, 3) rotation.
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
