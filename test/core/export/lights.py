# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A light to export: one lamp in a dim room, a part of which nobody saw."""

import dataclasses

import numpy as np

from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions
from test.core.surfaces import sphere_surface, without_observations

ROOM = np.array([0.02, 0.03, 0.04], np.float32)
LAMP = np.array([6.0, 5.0, 4.0], np.float32)


def lamp_towards(direction, width=8.0):
    """A lamp ``width`` degrees across; what lies behind it (a half space) was not seen."""
    unit = np.asarray(direction, np.float64) / np.linalg.norm(direction)
    cosine = octahedral_directions(SIZE) @ unit
    radiance = np.where(cosine[..., None] > np.cos(np.radians(width / 2)), LAMP, ROOM)
    seen = (cosine > -0.2).astype(np.float32)
    return ObservedLight(
        (radiance * seen[..., None]).astype(np.float32), seen, np.zeros((SIZE, SIZE, 3), np.float32)
    )


def around(light):
    """A scan that saw the light and nothing of an object, whose shading would tell more."""
    return dataclasses.replace(without_observations(sphere_surface(voxels=3)), light=light)
