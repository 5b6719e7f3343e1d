"""Renders the table scene analytically: exact surfaces, Ward gloss, a depth camera's noise."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.scene.table_scene import (
    ELLIPSOIDS,
    FLOOR_HEIGHT,
    LIGHTS,
    ROOM_CENTRE,
    ROOM_RADIUS,
    TABLE_RADIUS,
)
from reflest_core.brdf.srgb import encode
from reflest_core.capture.camera import CameraIntrinsics

FOCAL_LENGTH = 525.0 / 640.0
"""Of the image's width: a VGA depth camera's view."""
GRAZING = 0.12
"""Cosine of the angle of incidence below which there is no depth."""
MISSED = 0.003
"""Share of the patches of 4 x 4 pixels without depth."""
CODES = 4096
SRGB = np.rint(255.0 * encode(np.arange(CODES) / (CODES - 1))).astype(np.uint8)
"""8-bit sRGB of linear radiance in [0, 1], by 4096 steps."""


def camera_of(width: int, height: int) -> CameraIntrinsics:
    """The pinhole camera of this resolution."""
    focal = FOCAL_LENGTH * width
    return CameraIntrinsics(width, height, focal, focal, 0.5 * (width - 1), 0.5 * (height - 1))


def render(
    camera: CameraIntrinsics, T_world_camera: NDArray[np.float64], number: int
) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
    """Colour (H, W, 3) 8-bit sRGB and depth (H, W) in millimetres, 0 where the sensor saw none.

    ``number`` seeds the depth's noise, which grows with the square of the distance (1.2 mm at
    0.4 m and 1.9 mm more for each square metre beyond, as measured for structured light). The
    sensor sees nothing at grazing angles, and misses patches of 4 x 4 pixels here and there.
    """
    rgb = np.empty((camera.height, camera.width, 3), np.uint8)
    depth = np.empty((camera.height, camera.width), np.uint16)
    lights = LIGHTS.copy()
    lights[:, :3] /= np.linalg.norm(lights[:, :3], axis=1, keepdims=True)
    _render(
        camera.fx, camera.cx, camera.cy, np.ascontiguousarray(T_world_camera), ELLIPSOIDS, lights,
        SRGB, number, rgb, depth,
    )  # fmt: skip
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
            _shade(direction, length, normal, albedo, rho_s, alpha, lights, srgb, rgb[row, column])
            cosine = -(
                direction[0] * normal[0] + direction[1] * normal[1] + direction[2] * normal[2]
            )
            if cosine < GRAZING * length or _uniform(row // 4, column // 4, number) < MISSED:
                depth[row, column] = 0
            else:
                depth[row, column] = _sensed(z, row, column, number)


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


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _shade(
    direction: NDArray[np.float64],
    length: float,
    normal: NDArray[np.float64],
    albedo: NDArray[np.float64],
    rho_s: float,
    alpha: float,
    lights: NDArray[np.float64],
    srgb: NDArray[np.uint8],
    pixel: NDArray[np.uint8],
) -> None:
    """Ward (Eq. 1) under distant lights, and an even sky over the diffuse part."""
    ox, oy, oz = -direction[0] / length, -direction[1] / length, -direction[2] / length
    cos_o = max(ox * normal[0] + oy * normal[1] + oz * normal[2], 1e-3)
    sky = 0.35 + 0.15 * normal[2]
    red, green, blue = albedo[0] * sky, albedo[1] * sky, albedo[2] * sky
    for number in range(len(lights)):
        light = lights[number]
        cos_i = light[0] * normal[0] + light[1] * normal[1] + light[2] * normal[2]
        if cos_i <= 0.0:
            continue
        gloss = 0.0
        if rho_s > 0.0:
            hx, hy, hz = light[0] + ox, light[1] + oy, light[2] + oz
            along = hx * normal[0] + hy * normal[1] + hz * normal[2]
            tan_squared = (hx * hx + hy * hy + hz * hz) / (along * along) - 1.0
            gloss = rho_s * math.exp(-tan_squared / (alpha * alpha))
            gloss /= 4.0 * math.pi * alpha * alpha * math.sqrt(cos_i * cos_o)
        red += (albedo[0] / math.pi + gloss) * light[3] * cos_i
        green += (albedo[1] / math.pi + gloss) * light[4] * cos_i
        blue += (albedo[2] / math.pi + gloss) * light[5] * cos_i
    last = len(srgb) - 1
    pixel[0] = srgb[int(min(red, 1.0) * last)]
    pixel[1] = srgb[int(min(green, 1.0) * last)]
    pixel[2] = srgb[int(min(blue, 1.0) * last)]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _sensed(z: float, row: int, column: int, number: int) -> int:
    """Depth in millimetres with noise; the sum of two uniform values stands for a normal one."""
    even = _uniform(row, column, 2 * number) + _uniform(row, column, 2 * number + 1) - 1.0
    sigma = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4)
    return int((z + sigma * math.sqrt(6.0) * even) * 1000.0 + 0.5)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _uniform(row: int, column: int, seed: int) -> float:
    """A value in [0, 1) hashed from three whole numbers."""
    h = np.uint64(row) * np.uint64(0x9E3779B97F4A7C15)
    h ^= np.uint64(column) * np.uint64(0xD6E8FEB86659FD93)
    h ^= np.uint64(seed) * np.uint64(0xC2B2AE3D27D4EB4F)
    for _ in range(2):
        h ^= h >> np.uint64(32)
        h *= np.uint64(0xBF58476D1CE4E5B9)
    h ^= h >> np.uint64(29)
    return float(h >> np.uint64(11)) / 9007199254740992.0
