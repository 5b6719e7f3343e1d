# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light for training that is richer than a folder of environments: mixed, warped, with lamps.

A network that knows two dozen environments by heart fails under the next one. Each draw here is a
new environment that keeps what natural light has: a few small strong sources over broad soft ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.special import expit

from reflest_core.light.equirectangular import equirectangular_directions
from reflest_core.synbrdf.lights.environments import rotated
from reflest_core.synbrdf.lights.procedural_room import procedural_room
from reflest_core.synbrdf.lights.procedural_sky import procedural_sky

SOURCE_SHARES = (0.45, 0.3, 0.1, 0.15)
"""One natural map; two or three of them mixed; a procedural sky; a procedural room."""
MIXED_IN_SHARE = 0.25
"""Of natural light has a procedural room or sky mixed in."""


@dataclass(frozen=True)
class DiverseLight:
    """A drawn environment.

    Attributes:
        radiance: (H, 2 H, 3) float32, linear sRGB, equirectangular, z up.
        natural: Names of the environments in it, if any.
    """

    radiance: NDArray[np.float32]
    natural: tuple[str, ...]


def draw_diverse_light(
    rng: np.random.Generator, maps: Mapping[str, NDArray[np.float32]]
) -> DiverseLight:
    """Draw an environment as large as the maps.

    Args:
        rng: random numbers; the same state draws the same.
        maps: (H, 2 H, 3) linear radiance of environments by name, equirectangular, z up.
    """
    names = list(maps)
    height = maps[names[0]].shape[0]
    kind = int(rng.choice(4, p=SOURCE_SHARES))
    natural: tuple[str, ...] = ()
    if kind < 2:
        count = 1 if kind == 0 else int(rng.integers(2, 4))
        natural = tuple(names[k] for k in rng.integers(len(names), size=count))
        parts = [_turned(rng, maps[name]) for name in natural]
        if rng.uniform() < MIXED_IN_SHARE:
            parts.append(_made(rng, height, is_room=rng.uniform() < 0.5))
    else:
        parts = [_made(rng, height, is_room=kind == 3)]
    shares = rng.dirichlet(np.ones(len(parts)))
    radiance = sum(
        share / part.mean() * part.astype(np.float64)
        for share, part in zip(shares, parts, strict=True)
    )
    return DiverseLight(_varied(rng, np.asarray(radiance)).astype(np.float32), natural)


def _turned(rng: np.random.Generator, radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    turned = rotated(radiance, float(rng.uniform(0.0, 2.0 * np.pi)))
    return turned[:, ::-1] if rng.uniform() < 0.5 else turned


def _made(rng: np.random.Generator, height: int, is_room: bool) -> NDArray[np.float32]:
    seed = int(rng.integers(2**31))
    return procedural_room(seed, height) if is_room else procedural_sky(seed, height)


def _varied(rng: np.random.Generator, radiance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Change contrast, regional brightness and tint; add lamps."""
    height = radiance.shape[0]
    mean = radiance.mean()
    contrast = rng.uniform(0.75, 1.3)
    varied = mean * (radiance / mean) ** contrast
    if rng.uniform() < 0.5:
        brightness, *tints = (_smooth_field(rng, height) for _ in range(4))
        field = 0.35 * brightness[..., None] + 0.08 * np.stack(tints, axis=-1)
        varied = varied * np.exp(field)
    if rng.uniform() < 0.35:
        varied = varied + _lamps(rng, height, varied.mean())
    return np.asarray(varied * np.exp(rng.normal(0.0, 0.15, 3)))


def _smooth_field(rng: np.random.Generator, height: int) -> NDArray[np.float64]:
    noise = rng.normal(size=(height, 2 * height))
    field = gaussian_filter(noise, height / 6.0, mode=("nearest", "wrap"))
    return np.asarray(field / field.std())


def _lamps(rng: np.random.Generator, height: int, mean: float) -> NDArray[np.float64]:
    """Return one to four soft round lamps; together they send 0.2 to 3 times the other light."""
    towards = equirectangular_directions(height)
    lamps = np.zeros((height, 2 * height, 3))
    for _ in range(int(rng.integers(1, 5))):
        axis = rng.normal(size=3) + np.array([0.0, 0.0, 0.6])
        axis /= np.linalg.norm(axis)
        radius = np.deg2rad(np.exp(rng.uniform(np.log(1.5), np.log(25.0))))
        outside = np.arccos(np.clip(towards @ axis, -1.0, 1.0)) - radius
        glow = expit(-outside / (0.15 * radius))
        colour = np.exp(rng.normal(0.0, 0.15, 3) * np.array([1.0, 0.3, 1.0]))
        lamps += rng.uniform(0.3, 1.0) * (glow / glow.mean())[..., None] * colour
    power = np.exp(rng.uniform(np.log(0.2), np.log(3.0)))
    return np.asarray(lamps / lamps.mean() * power * mean)
