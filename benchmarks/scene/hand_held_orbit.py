# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The path of a camera that is carried round the object at a brisk pace."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.scenes.views import look_at

DEGREES_PER_SECOND = 15.0
"""One way round takes 24 s."""


def pose_at(seconds: float) -> NDArray[np.float64]:
    """The camera's pose; no two laps are equal.

    The camera stays 0.48 to 0.72 m from the object and 15 to 60 degrees above its horizon, and
    trembles by some millimetres.

    Args:
        seconds: Since the start.

    Returns:
        ``T_world_camera``, (4, 4) float64.
    """
    t = seconds
    azimuth = math.radians(DEGREES_PER_SECOND * t) + 0.05 * math.sin(0.9 * t)
    elevation = math.radians(37.0 + 20.0 * math.sin(0.41 * t) + 2.5 * math.sin(1.7 * t))
    distance = 0.60 + 0.10 * math.sin(0.31 * t + 1.0) + 0.02 * math.sin(1.3 * t)
    direction = np.array(
        [
            math.cos(elevation) * math.cos(azimuth),
            math.cos(elevation) * math.sin(azimuth),
            math.sin(elevation),
        ]
    )
    aim = np.array([0.0, 0.0, 0.13]) + 0.015 * np.sin(np.array([0.7, 0.9, 1.1]) * t)
    tremor = 0.002 * np.sin(np.array([7.3, 9.1, 8.2]) * t + np.array([0.0, 1.0, 2.0]))
    return look_at(aim + distance * direction + tremor, aim, math.radians(3.0 * math.sin(0.8 * t)))
