# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Worlds that do not have z up, turned so that they do: light comes mostly from above."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

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
    rotation = _shortest_rotation_to_z(np.array(up) / np.linalg.norm(up)).astype(np.float32)
    return dataclasses.replace(
        surface,
        positions=surface.positions @ rotation.T,
        normals=surface.normals @ rotation.T,
        view_centres=surface.view_centres @ rotation.T,
        light=None if surface.light is None else turned_light(surface.light, rotation),
    )


def _shortest_rotation_to_z(up: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3) rotation with ``R up = z``: two reflections, which hold for any unit ``up``."""
    z = np.array([0.0, 0.0, 1.0])
    if up[2] < -0.999999:
        return np.diag([1.0, -1.0, -1.0])
    middle = (up + z) / np.linalg.norm(up + z)
    reflect_middle = 2 * np.outer(middle, middle) - np.eye(3)
    reflect_up = 2 * np.outer(up, up) - np.eye(3)
    rotation: NDArray[np.float64] = reflect_middle @ reflect_up
    return rotation
