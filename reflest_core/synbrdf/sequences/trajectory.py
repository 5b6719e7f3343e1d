# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The path of a hand that walks a camera round an object and films it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.scenes.views import look_at, smooth_noise

DISTANCES = (0.4, 0.8)
"""Metres from the camera to the object's centre; a large object pushes the nearer one out."""
ELEVATIONS = (10.0, 60.0)
"""Degrees above the object's horizon."""
SWEEPS = (300.0, 400.0)
"""Degrees that the camera goes round."""


def hand_held_orbit(
    rng: np.random.Generator, count: int, object_diameter: float
) -> NDArray[np.float64]:
    """Draw ``count`` poses ``T_world_camera`` (count, 4, 4) round an object at the origin.

    One way round while the height rises and falls twice, and distance, aim and roll wander as a
    hand's do. World z is up; optical frames.
    """
    time = np.linspace(0.0, 1.0, count)
    sweep = np.deg2rad(rng.uniform(*SWEEPS)) * rng.choice([-1.0, 1.0])
    azimuth = rng.uniform(0.0, 2.0 * np.pi) + sweep * time
    middle, swing = np.mean(ELEVATIONS), 0.5 * np.ptp(ELEVATIONS)
    waves = np.cos(2.0 * np.pi * rng.uniform(1.6, 2.2) * time + rng.uniform(0.0, 2.0 * np.pi))
    wander = np.clip(smooth_noise(rng, count), -1.0, 1.0)
    elevation = np.deg2rad(middle + swing * (0.85 * waves + 0.15 * wander))
    nearest = max(DISTANCES[0], 1.3 * object_diameter)
    farthest = max(DISTANCES[1], 1.2 * nearest)
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
