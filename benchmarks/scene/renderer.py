# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Renders the table scene analytically: nearest surface, its colour, its measured depth."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.scene.depth_sensor import sensed_depth
from benchmarks.scene.shading import SRGB, shade
from benchmarks.scene.table_scene import (
    ELLIPSOIDS,
    FLOOR_HEIGHT,
    LIGHTS,
    ROOM_CENTRE,
    ROOM_RADIUS,
    TABLE_RADIUS,
)
from reflest_core.capture.camera import CameraIntrinsics

FOCAL_LENGTH = 525.0 / 640.0
"""Of the image's width: a VGA depth camera's view."""


def camera_of(width: int, height: int) -> CameraIntrinsics:
    """The pinhole camera of a resolution.

    Args:
        width: Pixels.
        height: Pixels.
    """
    focal = FOCAL_LENGTH * width
    return CameraIntrinsics(width, height, focal, focal, 0.5 * (width - 1), 0.5 * (height - 1))


def render(
    camera: CameraIntrinsics, T_world_camera: NDArray[np.float64], number: int
) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
    """Render one frame.

    Args:
        camera: The pinhole camera.
        T_world_camera: (4, 4) pose of the optical frame.
        number: Of the frame, a seed of the depth's noise.

    Returns:
        Colour (H, W, 3) 8-bit sRGB, and depth (H, W) uint16 in millimetres, 0 for no depth.
    """
    rgb = np.empty((camera.height, camera.width, 3), np.uint8)
    depth = np.empty((camera.height, camera.width), np.uint16)
    lights = LIGHTS.copy()
    lights[:, :3] /= np.linalg.norm(lights[:, :3], axis=1, keepdims=True)
    _render(
        camera.fx,
        camera.cx,
        camera.cy,
        np.ascontiguousarray(T_world_camera),
        ELLIPSOIDS,
        lights,
        SRGB,
        number,
        rgb,
        depth,
    )
    return rgb, depth


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _render(
    focal: float,
    cx: float,
    cy: float,
    T: NDArray[np.float64],
    ellipsoids: NDArray[np.float64],
    lights: NDArray[np.float64],
    srgb: NDArray[np.uint8],
    number: int,
    rgb: NDArray[np.uint8],
    depth: NDArray[np.uint16],
) -> None:
    height, width = depth.shape
    direction, normal, albedo = np.empty(3), np.empty(3), np.empty(3)
    origin = T[:3, 3].copy()
    for row in range(height):
        for column in range(width):
            a, b = (column - cx) / focal, (row - cy) / focal
            for axis in range(3):
                direction[axis] = T[axis, 0] * a + T[axis, 1] * b + T[axis, 2]
            z, rho_s, alpha = _hit(origin, direction, ellipsoids, normal, albedo)
            length = math.sqrt(a * a + b * b + 1.0)
            shade(direction, length, normal, albedo, rho_s, alpha, lights, srgb, rgb[row, column])
            cosine = -(
                direction[0] * normal[0] + direction[1] * normal[1] + direction[2] * normal[2]
            )
            depth[row, column] = sensed_depth(z, cosine / length, row, column, number)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _hit(
    origin: NDArray[np.float64],
    direction: NDArray[np.float64],
    ellipsoids: NDArray[np.float64],
    normal: NDArray[np.float64],
    albedo: NDArray[np.float64],
) -> tuple[float, float, float]:
    """Depth, ``rho_s`` and ``alpha`` of what the ray meets first; fills normal and albedo."""
    nearest, rho_s, alpha = np.inf, 0.0, 1.0
    for number in range(len(ellipsoids)):
        one = ellipsoids[number]
        aa, bb, cc = 0.0, 0.0, -1.0
        for axis in range(3):
            o = (origin[axis] - one[axis]) / one[3 + axis]
            d = direction[axis] / one[3 + axis]
            aa, bb, cc = aa + d * d, bb + o * d, cc + o * o
        square = bb * bb - aa * cc
        if square <= 0.0:
            continue
        z = (-bb - math.sqrt(square)) / aa
        if 0.0 < z < nearest:
            nearest, rho_s, alpha = z, one[9], one[10]
            for axis in range(3):
                at = origin[axis] + z * direction[axis] - one[axis]
                normal[axis] = at / (one[3 + axis] * one[3 + axis])
                albedo[axis] = one[6 + axis]
    for height, radius in ((0.0, TABLE_RADIUS), (FLOOR_HEIGHT, np.inf)):
        z = (height - origin[2]) / direction[2]
        x, y = origin[0] + z * direction[0], origin[1] + z * direction[1]
        if 0.0 < z < nearest and x * x + y * y < radius * radius:
            nearest, rho_s, alpha = z, 0.0, 1.0
            normal[0], normal[1], normal[2] = 0.0, 0.0, 1.0
            grain = 0.5 + 0.5 * math.sin(40.0 * x + 3.0 * math.sin(9.0 * y))
            albedo[0], albedo[1], albedo[2] = 0.30 + 0.2 * grain, 0.20 + 0.15 * grain, 0.14
    bb, cc, aa = 0.0, -ROOM_RADIUS * ROOM_RADIUS, 0.0
    for axis in range(3):
        o = origin[axis] - ROOM_CENTRE[axis]
        aa, bb, cc = aa + direction[axis] ** 2, bb + o * direction[axis], cc + o * o
    z = (-bb + math.sqrt(bb * bb - aa * cc)) / aa
    if z < nearest:
        nearest, rho_s, alpha = z, 0.0, 1.0
        for axis in range(3):
            normal[axis] = ROOM_CENTRE[axis] - origin[axis] - z * direction[axis]
        stripe = 0.1 * math.sin(6.0 * normal[0]) * math.sin(5.0 * normal[2])
        albedo[0], albedo[1], albedo[2] = 0.55 + stripe, 0.55, 0.5 - stripe
    length = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    for axis in range(3):
        normal[axis] /= length
    return nearest, rho_s, alpha
