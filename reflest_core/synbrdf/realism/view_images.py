# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What drifting colours make of a scene's thumbnails: their own pixels, and each view's F and B."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.jit import compiled, kernel_array
from reflest_core.synbrdf.scenes.thumbnails import Thumbnails

ENTRIES = 4096
"""Of the sRGB table, even in the square root of linear light."""
TABLE = np.rint(255.0 * srgb.encode(((np.arange(ENTRIES) + 0.5) / ENTRIES) ** 2)).astype(np.float32)
UNITS = np.where(np.arange(256) > 0, np.ldexp(1.0, np.arange(256) - 136), 0.0).astype(np.float32)
"""Radiance of one step of a mantissa, by the exponent's byte."""


@dataclass(frozen=True)
class ViewImages:
    """Small images of W views, and their mean colours.

    Attributes:
        rgbe: (W, H, W', 4) uint8, linear sRGB radiance.
        foreground: (W, 3) float32, mean 8-bit colour of each view's object.
        background: (W, 3) float32, of the rest.
    """

    rgbe: NDArray[np.uint8]
    foreground: NDArray[np.float32]
    background: NDArray[np.float32]


def meter(thumbnails: Thumbnails) -> NDArray[np.float64]:
    """(W,) geometric mean of each view's luminance, as auto exposure sees it.

    Args:
        thumbnails: small images of all views.
    """
    return _meter(kernel_array(thumbnails.rgbe, np.uint8))


def with_gains(thumbnails: Thumbnails, exposure: float, gains: NDArray[np.float32]) -> ViewImages:
    """Scale every view's radiance and average what the camera shows.

    Args:
        thumbnails: small images of all W views.
        exposure: factor from radiance to the sensor's white.
        gains: (W, 3) factors.
    """
    return ViewImages(
        *_with_gains(
            kernel_array(thumbnails.rgbe, np.uint8),
            kernel_array(thumbnails.is_object, np.bool_),
            exposure,
            kernel_array(gains, np.float32),
            TABLE,
            UNITS,
        )
    )


@compiled
def _meter(rgbe: NDArray[np.uint8]) -> NDArray[np.float64]:
    views, height, width, _ = rgbe.shape
    means = np.zeros(views)
    for view in range(views):
        total = 0.0
        for v in range(height):
            for u in range(width):
                red, green, blue, exponent = rgbe[view, v, u]
                light = 0.2126 * red + 0.7152 * green + 0.0722 * blue + 0.5
                total += np.log2(light) + exponent
        means[view] = 2.0 ** (total / (height * width) - 136.0)
    return means


@compiled
def _with_gains(
    rgbe: NDArray[np.uint8],
    is_object: NDArray[np.bool_],
    exposure: float,
    gains: NDArray[np.float32],
    table: NDArray[np.float32],
    units: NDArray[np.float32],
) -> tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.float32]]:
    views, height, width, _ = rgbe.shape
    scaled = np.zeros_like(rgbe)
    means = np.zeros((2, views, 3), np.float32)
    sums, counts = np.zeros((2, 3)), np.zeros(2, np.int64)
    last = np.float32(table.size - 1)
    for view in range(views):
        sums[:], counts[:] = 0.0, 0
        red_gain, green_gain, blue_gain = gains[view]
        for v in range(height):
            for u in range(width):
                red, green, blue, exponent = rgbe[view, v, u]
                # As rgbe.decode: the middle of each mantissa's step.
                red = (red + np.float32(0.5)) * red_gain
                green = (green + np.float32(0.5)) * green_gain
                blue = (blue + np.float32(0.5)) * blue_gain
                shown = units[exponent] * np.float32(exposure)
                part = 0 if is_object[view, v, u] else 1
                counts[part] += 1
                sums[part, 0] += table[int(np.sqrt(min(red * shown, 1)) * last)]
                sums[part, 1] += table[int(np.sqrt(min(green * shown, 1)) * last)]
                sums[part, 2] += table[int(np.sqrt(min(blue * shown, 1)) * last)]
                if exponent == 0:
                    continue
                # As rgbe.encode: the largest mantissa comes to lie in [128, 256).
                brightest = max(red, green, blue)
                unit, shift = np.float32(1.0), 0
                while brightest * unit >= 256.0:
                    unit, shift = unit * np.float32(0.5), shift + 1
                while brightest * unit < 128.0:
                    unit, shift = unit * np.float32(2.0), shift - 1
                scaled[view, v, u, 0] = int(red * unit)
                scaled[view, v, u, 1] = int(green * unit)
                scaled[view, v, u, 2] = int(blue * unit)
                scaled[view, v, u, 3] = exponent + shift
        for part in range(2):
            for k in range(3):
                means[part, view, k] = sums[part, k] / counts[part] if counts[part] else np.nan
    return scaled, means[0], means[1]
