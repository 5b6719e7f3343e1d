# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The scene: a glossy vase on a round table in a room, with clutter beside it.

World frame: z up, the table top at z = 0, metres.
"""

from __future__ import annotations

import numpy as np

from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.settings import RegionSettings

VERSION = 1
"""Recordings of another version are rendered again."""

ELLIPSOIDS = np.array(
    [
        # centre, half axes, albedo, rho_s, alpha: body, neck and handle of the vase, then clutter
        [0.0, 0.0, 0.105, 0.12, 0.12, 0.105, 0.45, 0.10, 0.07, 0.20, 0.10],
        [0.0, 0.0, 0.23, 0.065, 0.065, 0.065, 0.45, 0.10, 0.07, 0.20, 0.10],
        [0.10, 0.0, 0.155, 0.07, 0.03, 0.05, 0.45, 0.10, 0.07, 0.20, 0.10],
        [0.38, 0.16, 0.05, 0.05, 0.05, 0.05, 0.12, 0.30, 0.45, 0.02, 0.30],
        [-0.36, -0.20, 0.04, 0.08, 0.05, 0.04, 0.50, 0.45, 0.15, 0.02, 0.30],
    ]
)
"""(5, 11): the object is the first three."""

TABLE_RADIUS = 0.6
FLOOR_HEIGHT = -0.75
ROOM_CENTRE = np.array([0.0, 0.0, 0.6])
ROOM_RADIUS = 2.6

LIGHTS = np.array(
    [
        # direction to the light (normalised when used), radiance of red, green and blue
        [0.5, 0.3, 0.9, 1.6, 1.5, 1.4],
        [-0.7, 0.4, 0.5, 0.5, 0.55, 0.7],
        [0.1, -0.9, 0.35, 0.45, 0.4, 0.35],
    ]
)

REGION = RegionSettings("box", (0.02, 0.0, 0.155), (0.38, 0.30, 0.30))
"""Holds the object and begins 5 mm above the table."""


def table_settings() -> ReflestSettings:
    """The default settings, with the region around the object."""
    return ReflestSettings(region=REGION)
