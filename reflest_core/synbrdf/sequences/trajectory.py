# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The path of a hand that walks a camera round an object and films it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.scenes.views import look_at, smooth_noise


@dataclass(frozen=True)
class Orbit:
    """Ranges of a camera's path.

    Attributes:
        distances: Metres from the camera to the origin; a large object pushes the nearer one out.
        elevations: Degrees above the horizon.
        sweeps: Degrees that the camera goes round.
        middle: Azimuth of the path's middle in degrees; None for any.
    """

    distances: tuple[float, float]
    elevations: tuple[float, float]
    sweeps: tuple[float, float]
    middle: float | None = None


ROUND_AN_OBJECT = Orbit((0.4, 0.8), (10.0, 60.0), (300.0, 400.0))


def hand_held_orbit(
    rng: np.random.Generator, count: int, object_diameter: float, orbit: Orbit = ROUND_AN_OBJECT
) -> NDArray[np.float64]:
    """Draw the path of a camera round an object at the origin.

    One way round while the height rises and falls twice, and distance, aim and roll wander as a
    hand's do.

    Args:
        rng: Source of the draw.
        count: Poses.
        object_diameter: Metres.
        orbit: Ranges of the path.

    Returns:
        ``T_world_camera`` (count, 4, 4) of optical frames; world z is up.
    """
    time = np.linspace(0.0, 1.0, count)
    sweep = np.deg2rad(rng.uniform(*orbit.sweeps)) * rng.choice([-1.0, 1.0])
    start = rng.uniform(0.0, 2.0 * np.pi)
    if orbit.middle is not None:
        start = np.deg2rad(orbit.middle) - 0.5 * sweep
    azimuth = start + sweep * time
    middle, swing = np.mean(orbit.elevations), 0.5 * np.ptp(orbit.elevations)
    waves = np.cos(2.0 * np.pi * rng.uniform(1.6, 2.2) * time + rng.uniform(0.0, 2.0 * np.pi))
    wander = np.clip(smooth_noise(rng, count), -1.0, 1.0)
    elevation = np.deg2rad(middle + swing * (0.85 * waves + 0.15 * wander))
    nearest = max(orbit.distances[0], 1.3 * object_diameter)
    farthest = max(orbit.distances[1], 1.2 * nearest)
    share = 0.5 + 0.5 * np.tanh(1.2 * smooth_noise(rng, count))
    distance = nearest + (farthest - nearest) * share
    directions = np.stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ],
        axis=1,
    )
    aims = 0.1 * object_diameter * smooth_noise(rng, count, 3)
    rolls = np.deg2rad(5.0) * smooth_noise(rng, count)
    return np.stack(
        [
            look_at(direction * metres, aim, float(roll))
            for direction, metres, aim, roll in zip(directions, distance, aims, rolls, strict=True)
        ]
    )
