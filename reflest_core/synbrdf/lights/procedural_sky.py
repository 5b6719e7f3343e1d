# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Natural-looking light from a seed, so that nothing need be downloaded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

FloatArray = NDArray[np.float64]


def procedural_sky(seed: int, height: int = 128) -> NDArray[np.float32]:
    """Return an outdoor environment (height, 2 * height, 3), linear Rec. 709, z up.

    A graded sky, a sun with its glow, soft clouds, a skyline of blocks and trees, and a ground.

    Args:
        seed: of the random numbers.
        height: rows of the equirectangular map.
    """
    rng = np.random.default_rng(np.random.SeedSequence([0x5C1, seed]))
    polar = (np.arange(height) + 0.5) / height * np.pi
    azimuth = (0.5 - (np.arange(2 * height) + 0.5) / (2 * height)) * 2.0 * np.pi
    elevation = np.broadcast_to(0.5 * np.pi - polar[:, None], (height, 2 * height))
    sun_elevation = np.deg2rad(rng.uniform(8.0, 60.0))
    sun = _direction(np.array(rng.uniform(-np.pi, np.pi)), np.array(sun_elevation))
    towards_sun = np.clip(_direction(azimuth[None, :], elevation) @ sun, -1.0, 1.0)

    warmth = np.exp(-sun_elevation / 0.35)
    image = _graded_sky(rng, elevation, warmth)
    clouds = _clouds(rng, height)
    image = image * (1.0 - 0.6 * clouds) + clouds * rng.uniform(0.5, 1.2)
    sunlight = np.array([1.0, 0.92 - 0.35 * warmth, 0.82 - 0.6 * warmth])
    veil = 1.0 - 0.85 * clouds[..., :1]
    glow = 1.5 * np.exp((towards_sun - 1.0) / 0.02) + 0.4 * np.exp((towards_sun - 1.0) / 0.2)
    image += glow[..., None] * sunlight
    # The sun is drawn 4 degrees across at a brightness that keeps its true share of the light.
    disc = np.exp((towards_sun - 1.0) / (1.0 - np.cos(np.deg2rad(2.0))))
    image += rng.uniform(200.0, 900.0) * disc[..., None] * sunlight * veil
    return _with_ground(rng, image, elevation, azimuth, sunlight).astype(np.float32)


def _direction(azimuth: FloatArray, elevation: FloatArray) -> FloatArray:
    return np.stack(
        np.broadcast_arrays(
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ),
        axis=-1,
    )


def _graded_sky(rng: np.random.Generator, elevation: FloatArray, warmth: float) -> FloatArray:
    zenith = np.array([0.12, 0.25, 0.6]) * rng.uniform(0.7, 1.6)
    horizon = np.array([0.65, 0.75, 0.9]) * (1.0 - warmth) + np.array([1.0, 0.6, 0.35]) * warmth
    share = np.exp(-np.maximum(elevation, 0.0) / rng.uniform(0.25, 0.6))[..., None]
    return np.asarray(zenith * (1.0 - share) + horizon * share)


def _clouds(rng: np.random.Generator, height: int) -> FloatArray:
    """Opacity (height, 2 * height, 1) in [0, 1] of soft noise at several scales."""
    total = np.zeros((height, 2 * height))
    for octave in range(4):
        scale = height / 12.0 / 2**octave
        noise = gaussian_filter(
            rng.normal(size=total.shape), (scale * 0.5, scale), mode=("nearest", "wrap")
        )
        total += noise / noise.std() / 1.7**octave
    cover = rng.uniform(-0.8, 1.2)
    return np.asarray(1.0 / (1.0 + np.exp(-3.0 * (total + cover - 0.5))))[..., None]


def _with_ground(
    rng: np.random.Generator,
    sky: FloatArray,
    elevation: FloatArray,
    azimuth: FloatArray,
    sunlight: FloatArray,
) -> FloatArray:
    """Put a skyline and a lit ground under the sky."""
    blocks = np.zeros(azimuth.size)
    for _ in range(int(rng.integers(6, 24))):
        width, top = rng.uniform(0.05, 0.5), np.deg2rad(rng.uniform(1.0, 22.0))
        apart = np.angle(np.exp(1j * (azimuth - rng.uniform(-np.pi, np.pi))))
        blocks = np.maximum(blocks, np.where(np.abs(apart) < width / 2, top, 0.0))
    tint = rng.uniform(0.1, 0.5) * rng.dirichlet([8.0, 8.0, 6.0]) * 3.0
    solid_angle = np.cos(elevation)[..., None]
    above = elevation[..., None] > 0.0
    irradiance = (sky * above * np.sin(np.maximum(elevation, 0.0))[..., None] * solid_angle).sum(
        axis=(0, 1)
    ) * (np.pi / sky.shape[0]) ** 2
    shade = rng.uniform(0.6, 1.4, azimuth.size // 8 + 1).repeat(8)[: azimuth.size, None]
    wall = tint[::-1] * irradiance * shade / np.pi * 0.35
    texture = 1.0 + 0.25 * gaussian_filter(
        rng.normal(size=elevation.shape), 1.5, mode=("nearest", "wrap")
    )
    ground = tint * irradiance / np.pi * texture[..., None]
    image = np.where((elevation < blocks)[..., None], np.broadcast_to(wall, sky.shape), sky)
    image = np.where(above, image, ground)
    return np.maximum(image, 0.0)
