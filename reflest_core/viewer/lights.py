# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The lights to show a scan in: its own, and others, turned about the vertical."""

from __future__ import annotations

import enum
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.light.completion import LightPyramid, levels_below
from reflest_core.light.environment_reader import read_radiance
from reflest_core.light.equirectangular import equirectangular_directions, radiance_from
from reflest_core.light.light_map import SIZE
from reflest_core.light.octahedral import octahedral_directions, octahedral_texels
from reflest_core.rendering.environments import studio
from reflest_core.viewer.source import ViewerError

ACROSS = 3
"""Directions along each edge of a texel that are averaged."""


class Light(enum.Enum):
    """A light by the name that the page shows."""

    ESTIMATED = "Estimated"
    STUDIO = "Studio"
    LAMP = "One lamp"
    OVERCAST = "Overcast sky"
    FILE = "From the file"


def read_light(file: Path) -> NDArray[np.float32]:
    """Read an environment.

    Args:
        file: An equirectangular .hdr or .exr image.

    Returns:
        (H, 2 H, 3) linear radiance in the file's unit, z up.

    Raises:
        ViewerError: The file cannot be used.
    """
    try:
        radiance = read_radiance(file).radiance
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ViewerError(f"the light {file} cannot be used: {reason}") from None
    height, width = radiance.shape[:2]
    if width != 2 * height or not np.isfinite(radiance).all() or not radiance.max() > 0.0:
        raise ViewerError(
            f"the light {file} has {width} x {height} pixels: expected an equirectangular image, "
            "twice as wide as high, of finite radiance that is not all 0"
        )
    return np.maximum(radiance, 0.0)


@cache
def invented_light(light: Light) -> NDArray[np.float32]:
    """A light that no scan holds.

    Args:
        light: :attr:`Light.LAMP`, :attr:`Light.OVERCAST`; anything else is the studio.

    Returns:
        (H, 2 H, 3) linear radiance, z up, in a unit of its own.
    """
    if light not in (Light.LAMP, Light.OVERCAST):
        return studio()
    directions = equirectangular_directions(128)
    if light is Light.LAMP:
        towards = np.array([0.5, -0.45, 0.74])
        cosine = (directions @ (towards / np.linalg.norm(towards)))[..., None]
        return np.asarray(0.12 + 60.0 * (cosine > np.cos(0.12)) * np.ones(3), np.float32)
    # CIE's overcast sky (Moon and Spencer 1942): three times as bright at the zenith.
    rise = directions[..., 2:]
    above = (1.0 + 2.0 * np.clip(rise, 0.0, 1.0)) / 3.0 * np.array([0.96, 1.0, 1.06])
    return np.asarray(np.where(rise >= 0.0, above, [0.14, 0.13, 0.12]), np.float32)


def octahedral_light(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    """Resample an equirectangular image.

    Args:
        radiance: (H, 2 H, 3).

    Returns:
        (SIZE, SIZE, 5) as the levels of :class:`.LightPyramid`, all of it seen.
    """
    fine = radiance_from(radiance, octahedral_directions(SIZE * ACROSS).reshape(-1, 3))
    cells = fine.reshape(SIZE, ACROSS, SIZE, ACROSS, 3).mean(axis=(1, 3))
    known = np.zeros((SIZE, SIZE, 2), np.float32)
    known[..., 0] = 1.0
    return np.concatenate([cells, known], axis=-1).astype(np.float32)


def turned_pyramid(octahedral: NDArray[np.float32], degrees: float) -> LightPyramid:
    """Turn a light about +z.

    Args:
        octahedral: (N, N, 5) the finest level.
        degrees: counter-clockwise, seen from above.

    Returns:
        The pyramid over the turned level.
    """
    if degrees % 360.0 == 0.0:
        return levels_below(octahedral)
    size = len(octahedral)
    angle = np.radians(degrees)
    c, s = np.cos(angle), np.sin(angle)
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    # What arrives from d came from the inverse rotation of d.
    sources = octahedral_directions(size * ACROSS).reshape(-1, 3) @ rotation
    looked_up = octahedral.reshape(-1, 5)[octahedral_texels(sources, size)]
    cells = looked_up.reshape(size, ACROSS, size, ACROSS, 5).mean(axis=(1, 3))
    return levels_below(np.ascontiguousarray(cells, np.float32))
