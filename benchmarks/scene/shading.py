# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The colour of a surface point: Ward gloss under distant lights."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.srgb import encode

CODES = 4096
SRGB = np.rint(255.0 * encode(np.arange(CODES) / (CODES - 1))).astype(np.uint8)
"""8-bit sRGB of linear radiance in [0, 1], by 4096 steps."""


@numba.njit(cache=True, nogil=True, error_model="numpy")
def shade(
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
    """Shade a point: Ward (Eq. 1) under distant lights, and a uniform sky on the diffuse part.

    Args:
        direction: (3,) ray from the camera, not normalised.
        length: Of ``direction``.
        normal: (3,) unit.
        albedo: (3,) linear ``rho_d``.
        rho_s: Ward's specular reflectance.
        alpha: Ward's roughness.
        lights: (L, 6) unit directions towards the lights and their linear colours.
        srgb: Table from linear values to 8-bit sRGB.
        pixel: (3,) 8-bit sRGB, which is written.
    """
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
