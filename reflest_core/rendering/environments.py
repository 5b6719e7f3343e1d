# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A light to show materials under: an invented studio that no scan and no training scene holds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class SoftBox:
    """A rectangular lamp around azimuth and elevation (radians), linear sRGB radiance."""

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
    """Lat-long radiance (height, 2 height, 3) float32, linear sRGB; row 0 is up (+z).

    Column 0 is azimuth -pi, azimuth 0 points along +x. A grey room, a warm floor, three lamps.
    """
    elevation = math.pi / 2 - (np.arange(height) + 0.5) * math.pi / height
    azimuth = (np.arange(2 * height) + 0.5) * math.pi / height - math.pi
    azimuth, elevation = np.meshgrid(azimuth, elevation)
    rise = np.sin(elevation)[..., None]
    walls = 0.35 + 0.25 * rise
    floor = np.array([0.34, 0.28, 0.22])
    radiance = np.where(rise > -0.15, walls * np.ones(3), floor)
    for lamp in STUDIO_LAMPS:
        turn = np.angle(np.exp(1j * (azimuth - lamp.azimuth))) * np.cos(elevation)
        inside = (abs(turn) < lamp.width / 2) & (abs(elevation - lamp.elevation) < lamp.height / 2)
        radiance[inside] = lamp.radiance
    return radiance.astype(np.float32)


def look_up(
    environment: NDArray[np.float32], directions: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Radiance (..., 3) towards unit ``directions`` (..., 3), nearest texel."""
    height, width = environment.shape[:2]
    row = np.arccos(np.clip(directions[..., 2], -1, 1)) / math.pi * height
    column = (np.arctan2(directions[..., 1], directions[..., 0]) / (2 * math.pi) + 0.5) * width
    rows = np.clip(row.astype(int), 0, height - 1)
    radiance: NDArray[np.float64] = environment[rows, column.astype(int) % width].astype(np.float64)
    return radiance


def irradiance(
    environment: NDArray[np.float32], normals: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Irradiance (P, 3) on unit ``normals`` (P, 3): the cosine-weighted sum over 32 x 64 cells."""
    cells = cv2.resize(environment, (64, 32), interpolation=cv2.INTER_AREA).reshape(-1, 3)
    polar = (np.arange(32) + 0.5) * math.pi / 32
    azimuth = (np.arange(64) + 0.5) * math.pi / 32 - math.pi
    azimuth, polar = (axis.reshape(-1) for axis in np.meshgrid(azimuth, polar))
    directions = np.stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)]
    )
    solid_angle = np.sin(polar) * (math.pi / 32) ** 2
    cosine = np.clip(normals @ directions, 0, None)
    arriving: NDArray[np.float64] = cosine @ (cells * solid_angle[:, None])
    return arriving
