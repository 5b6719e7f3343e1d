# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a camera sees of a scene's light that is turned round the room instead of the object."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.light.equirectangular import radiance_from
from reflest_core.synbrdf.relit.scene_light import Background, pixel_rays
from reflest_core.synbrdf.scenes.exposure import expose

RINGS = ((15.0, 8), (55.0, 6), (90.0, 1))
"""Elevation in degrees, and how many frames are taken around there: the upper half of the room."""
FRAMES = sum(count for _, count in RINGS)


def look_around(environment: NDArray[np.float32], exposure: float) -> list[Background]:
    """Take :data:`FRAMES` frames through the data set's camera.

    Args:
        environment: (H, 2 H, 3) linear radiance, equirectangular, infinitely far.
        exposure: factor from radiance to the sensor's white, the same for all frames.
    """
    frames = []
    for elevation, count in RINGS:
        for azimuth in np.arange(count) * 2.0 * np.pi / count:
            directions = pixel_rays() @ _facing(np.radians(elevation), azimuth).T
            unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
            colours = expose(radiance_from(environment, unit), exposure)
            frames.append((directions.astype(np.float32), colours))
    return frames


def _facing(elevation: float, azimuth: float) -> NDArray[np.float64]:
    """The rotation (3, 3), camera (x right, y down, z forward) to world, of a level camera."""
    forward = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    right = np.array([np.sin(azimuth), -np.cos(azimuth), 0.0])
    return np.stack([right, np.cross(forward, right), forward], axis=1)
