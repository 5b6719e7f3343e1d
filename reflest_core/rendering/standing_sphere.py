# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A sphere that stands on the floor of the studio: a material as people are used to see it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters
from reflest_core.rendering.environments import studio
from reflest_core.rendering.sphere import Image, on_sphere, render_environment, tone_map

EXPOSURE = 0.95
FILLED = 0.74
"""Diameter of the sphere over the picture's edge."""
CONTACT = 0.9
"""Row on which the sphere stands, from the top."""
HORIZON = 0.62
"""Row where the floor meets the wall, from the top."""
TILT = 0.22
"""Height over width of circles on the floor: the camera looks down a little."""
WALL_LOW, WALL_HIGH = 0.33, 0.52
FLOOR = np.array([0.34, 0.28, 0.22])
"""Linear radiance; as :func:`.studio` has walls and floor."""


def standing_sphere(parameters: WardParameters, size: int = 200) -> NDArray[np.uint8]:
    """Render the picture. The material lies in the studio's light, the floor in its shadow.

    Args:
        parameters: the material.
        size: pixels along an edge.

    Returns:
        (size, size, 3) 8-bit sRGB.
    """
    picture = _room(size)
    diameter = round(FILLED * size)
    ball = render_environment(parameters, studio(), diameter)
    inside = on_sphere(diameter)
    top = round(CONTACT * size) - diameter
    left = (size - diameter) // 2
    picture[top : top + diameter, left : left + diameter][inside] = ball[inside]
    return tone_map(picture, EXPOSURE)


def _room(size: int) -> Image:
    """(size, size, 3) linear radiance of wall and floor with the sphere's ambient shadow."""
    x, y = np.meshgrid(*2 * [(np.arange(size) + 0.5) / size])
    wall = WALL_HIGH + (WALL_LOW - WALL_HIGH) * (y / HORIZON)
    radius = 0.5 * FILLED
    # On the floor, in radii of the sphere from the point that it touches.
    reach = np.hypot((x - 0.5) / radius, (y - CONTACT) / (TILT * radius))
    # Share of the sky that a sphere of radius 1 at height 1 hides from a point of the floor.
    shadow = 1.0 / (1.0 + reach**2) ** 1.5
    floor = FLOOR * (1.0 - shadow)[..., None]
    return np.where((y < HORIZON)[..., None], wall[..., None] * np.ones(3), floor)
