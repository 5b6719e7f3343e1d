# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Indoor light from a seed: a box room with windows, lamps and furniture, seen from inside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from reflest_core.light.equirectangular import equirectangular_directions

FloatArray = NDArray[np.float64]


def procedural_room(seed: int, height: int = 128) -> NDArray[np.float32]:
    """Return an indoor environment (height, 2 * height, 3), linear Rec. 709, z up.

    The viewer stands anywhere in the room; walls are lit by the windows' and lamps' mean light
    and darken towards the corners, windows and lamps shine themselves.

    Args:
        seed: of the random numbers.
        height: rows of the equirectangular map.
    """
    rng = np.random.default_rng(np.random.SeedSequence([0x400, seed]))
    size = np.array([*rng.uniform(2.5, 9.0, 2), rng.uniform(2.3, 4.0)])
    viewer = size * np.array([*rng.uniform(0.15, 0.85, 2), rng.uniform(0.2, 0.6)])
    wall, spot = _walls(equirectangular_directions(height), size, viewer)
    emission = np.zeros((height, 2 * height, 3))
    emission += _windows(rng, wall, spot, size)
    emission += _ceiling_lamps(rng, wall, spot, size)
    albedo = _albedo(rng, wall, spot, height)
    corners = _corner_shade(wall, spot, size)
    bounced = rng.uniform(0.3, 1.5) * emission.mean(axis=(0, 1)) + 1e-3
    image = albedo * bounced * corners[..., None] + emission
    return np.asarray(image / image.mean(), np.float32)


def _walls(
    towards: FloatArray, size: FloatArray, viewer: FloatArray
) -> tuple[NDArray[np.int64], FloatArray]:
    """Which of six walls (axis * 2 + side) each direction meets, and where (H, W, 3) in metres."""
    planes = np.where(towards > 0, size, 0.0)
    with np.errstate(divide="ignore"):
        distance = np.where(towards == 0, np.inf, (planes - viewer) / towards)
    axis = distance.argmin(axis=-1)
    nearest = np.take_along_axis(distance, axis[..., None], axis=-1)
    is_far_side = np.take_along_axis(towards, axis[..., None], axis=-1)[..., 0] > 0
    return axis * 2 + is_far_side, viewer + nearest * towards


def _windows(
    rng: np.random.Generator, wall: NDArray[np.int64], spot: FloatArray, size: FloatArray
) -> FloatArray:
    """Daylight panes in up to two walls."""
    image = np.zeros(spot.shape)
    daylight = np.array([0.85, 0.95, 1.1]) * np.exp(rng.normal(0.0, 0.1, 3))
    for side in rng.permutation(4)[: int(rng.integers(0, 3))]:
        along, length = (1, size[1]) if side < 2 else (0, size[0])
        for _ in range(int(rng.integers(1, 4))):
            middle, half = rng.uniform(0.1, 0.9) * length, rng.uniform(0.3, 1.0)
            low, high = rng.uniform(0.0, 1.0), rng.uniform(1.8, 2.4)
            inside = (
                (wall == side)
                & (np.abs(spot[..., along] - middle) < half)
                & (spot[..., 2] > low)
                & (spot[..., 2] < high)
            )
            sky = 0.5 + (spot[..., 2] - low) / (high - low)
            image += (inside * sky * rng.uniform(10.0, 60.0))[..., None] * daylight
    return image


def _ceiling_lamps(
    rng: np.random.Generator, wall: NDArray[np.int64], spot: FloatArray, size: FloatArray
) -> FloatArray:
    """Round or long lamps under the ceiling; at least one, for a room is never black."""
    image = np.zeros(spot.shape)
    warm = np.array([1.2, 1.0, 0.7 + 0.4 * rng.uniform()])
    is_long = rng.uniform() < 0.5
    for _ in range(int(rng.integers(1, 7))):
        apart = spot[..., :2] - rng.uniform(0.1, 0.9, 2) * size[:2]
        if is_long:
            inside = (np.abs(apart[..., 0]) < 0.6) & (np.abs(apart[..., 1]) < 0.1)
        else:
            inside = np.hypot(apart[..., 0], apart[..., 1]) < rng.uniform(0.06, 0.35)
        image += ((wall == 5) & inside)[..., None] * warm * rng.uniform(50.0, 400.0)
    return image


def _albedo(
    rng: np.random.Generator, wall: NDArray[np.int64], spot: FloatArray, height: int
) -> FloatArray:
    """Paint, carpet and dark or bright patches of furniture on the lower walls."""
    paints = rng.uniform(0.15, 0.85, (6, 1)) * np.exp(rng.normal(0.0, 0.15, (6, 3)))
    paints[5] = rng.uniform(0.6, 0.9)
    albedo = paints[wall]
    for _ in range(int(rng.integers(3, 14))):
        corner = spot.reshape(-1, 3)[rng.integers(wall.size)] - rng.uniform(0.0, 0.6, 3)
        inside = ((spot > corner) & (spot < corner + rng.uniform(0.3, 1.8, 3))).all(axis=-1)
        inside &= spot[..., 2] < 2.0
        albedo[inside] = rng.uniform(0.03, 0.8) * np.exp(rng.normal(0.0, 0.4, 3))
    texture = gaussian_filter(rng.normal(size=wall.shape), height / 90.0, mode=("nearest", "wrap"))
    varied = albedo * (1.0 + 0.15 * texture / texture.std())[..., None]
    return np.asarray(np.clip(varied, 0.01, 0.95))


def _corner_shade(wall: NDArray[np.int64], spot: FloatArray, size: FloatArray) -> FloatArray:
    """Darkening within half a metre of where walls meet."""
    to_edges = np.minimum(spot, size - spot)
    np.put_along_axis(to_edges, (wall // 2)[..., None], np.inf, axis=-1)
    return np.asarray(1.0 - 0.5 * np.exp(-to_edges.min(axis=-1) / 0.4))
