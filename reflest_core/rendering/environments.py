# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A light to show materials under: an invented studio that no scan and no training scene holds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import kernel_array, vectorised
from reflest_core.light.equirectangular import (
    equirectangular_directions,
    equirectangular_solid_angles,
)

ROWS = 32
"""Of the coarse image that irradiance is summed over."""
LANES = 64
"""Normals for which it is summed at once, by vector instructions."""


@dataclass(frozen=True)
class SoftBox:
    """A rectangular lamp.

    Attributes:
        azimuth: Of its middle, radians.
        elevation: Of its middle, radians.
        width: Along the azimuth, radians.
        height: Along the elevation, radians.
        radiance: Linear sRGB.
    """

    azimuth: float
    elevation: float
    width: float
    height: float
    radiance: tuple[float, float, float]


STUDIO_LAMPS = (
    SoftBox(math.radians(50), math.radians(45), 0.9, 0.5, (9.0, 8.6, 8.0)),
    SoftBox(math.radians(-70), math.radians(25), 0.35, 1.1, (4.0, 4.6, 5.6)),
    SoftBox(math.radians(165), math.radians(60), 0.5, 0.25, (6.0, 5.2, 4.2)),
)


def studio(height: int = 128) -> NDArray[np.float32]:
    """Draw a grey room with a warm floor and three lamps.

    Args:
        height: Rows of the image.

    Returns:
        (height, 2 height, 3) linear sRGB radiance, see :mod:`reflest_core.light.equirectangular`.
    """
    directions = equirectangular_directions(height)
    azimuth = np.arctan2(directions[..., 1], directions[..., 0])
    elevation = np.arcsin(directions[..., 2])
    rise = np.sin(elevation)[..., None]
    walls = 0.35 + 0.25 * rise
    floor = np.array([0.34, 0.28, 0.22])
    radiance = np.where(rise > -0.15, walls * np.ones(3), floor)
    for lamp in STUDIO_LAMPS:
        turn = np.angle(np.exp(1j * (azimuth - lamp.azimuth))) * np.cos(elevation)
        inside = (abs(turn) < lamp.width / 2) & (abs(elevation - lamp.elevation) < lamp.height / 2)
        radiance[inside] = lamp.radiance
    return radiance.astype(np.float32)


def irradiance(
    environment: NDArray[np.float32], normals: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Sum the light on surfaces, over 32 x 64 cells of the environment.

    Args:
        environment: (H, 2 H, 3) linear radiance, equirectangular.
        normals: (P, 3) unit normals in the environment's frame.

    Returns:
        (P, 3) cosine-weighted irradiance.
    """
    cells = cv2.resize(environment, (2 * ROWS, ROWS), interpolation=cv2.INTER_AREA)
    weighted = cells * equirectangular_solid_angles(ROWS)[..., None]
    arriving = np.empty((len(normals), 3))
    directions = kernel_array(equirectangular_directions(ROWS).reshape(-1, 3), np.float64)
    light = kernel_array(weighted.reshape(-1, 3), np.float64)
    for first in range(0, len(normals), LANES):
        some = normals[first : first + LANES]
        padded = np.zeros((3, LANES))
        padded[:, : len(some)] = some.T
        arriving[first : first + LANES] = _sum_light(padded, directions, light)[:, : len(some)].T
    return arriving


@vectorised
def _sum_light(
    normals: NDArray[np.float64], directions: NDArray[np.float64], light: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(3, LANES) sums over the cells of cosine times light, for as many ``normals`` (3, LANES)."""
    sums = np.zeros(3 * LANES)
    for cell in range(len(directions)):
        x, y, z = directions[cell, 0], directions[cell, 1], directions[cell, 2]
        red, green, blue = light[cell, 0], light[cell, 1], light[cell, 2]
        for n in range(LANES):
            cosine = max(x * normals[0, n] + y * normals[1, n] + z * normals[2, n], 0.0)
            sums[n] += cosine * red
            sums[LANES + n] += cosine * green
            sums[2 * LANES + n] += cosine * blue
    return sums.reshape(3, LANES)
