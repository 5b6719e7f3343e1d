# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How well the colours of two frames meet under the poses that came with them.

Where one frame's depth lands on an earlier frame's, its colour detail is correlated with the detail
there. Detail is what is left of a reduced grey image without the mean of its surroundings, so that
exposure, white balance and slow shading do not matter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.poses.agreement import DepthSample, depth_tolerance
from reflest_core.jit import compiled, kernel_array

COLUMNS = 80
"""Columns of a reduced image, about: noise is averaged away, and motion blur matters little."""
SURROUNDINGS = 3
"""Pixels of the reduced image on each side whose mean is taken away."""
THUMBNAIL = 8
"""Rows and columns of a thumbnail."""
FEWEST = 40
"""With fewer samples where depth agrees a pair says nothing."""
LEAST_CONTRAST = 2.5
"""Standard deviation of the detail, in grey levels, from which on it is no noise."""


@dataclass(frozen=True)
class ColourAgreement:
    """How well the colour detail of two frames meets.

    Attributes:
        correlation: Of the detail, in [-1, 1].
        contrast: Standard deviation of the weaker detail, grey levels.
        count: Samples whose depth agrees.
    """

    correlation: float
    contrast: float
    count: int

    @property
    def is_known(self) -> bool:
        """Whether there was enough in sight, and enough texture, to judge by."""
        return self.count >= FEWEST and self.contrast >= LEAST_CONTRAST


@dataclass(frozen=True)
class ReducedImage:
    """What the colours of a frame are compared by.

    Attributes:
        detail: (H // s, W // s) grey levels over the mean of the surroundings, for a whole s.
        thumbnail: (THUMBNAIL, THUMBNAIL) mean grey levels; fewer of a tiny image.
    """

    detail: NDArray[np.float32]
    thumbnail: NDArray[np.float32]

    @staticmethod
    def of(rgb: NDArray[np.uint8]) -> ReducedImage:
        """Reduce an image.

        Args:
            rgb: (H, W, 3) 8-bit.
        """
        return ReducedImage(*_reduced(kernel_array(rgb, np.uint8), max(rgb.shape[1] // COLUMNS, 1)))


def colours_meet(
    later: tuple[DepthSample, ReducedImage],
    earlier: tuple[DepthSample, ReducedImage],
    T_earlier_later: NDArray[np.float64],
    most: int,
) -> ColourAgreement:
    """Correlate the detail of a frame with that of an earlier frame, where their depth agrees.

    Args:
        later: Depth and colours of the later frame.
        earlier: Depth and colours of the earlier frame.
        T_earlier_later: (4, 4) the later camera's optical frame in the earlier one's.
        most: Compare so many samples at most, about, taken evenly.
    """
    correlation, contrast, count = _correlated(
        later[0].rays,
        max(later[0].size // most, 1),
        kernel_array(T_earlier_later, np.float64),
        earlier[0].depth,
        earlier[0].pinhole,
        later[0].pinhole,
        earlier[1].detail,
        later[1].detail,
    )
    return ColourAgreement(correlation, contrast, count)


@compiled
def grey_blocks(rgb: NDArray[np.uint8], size: int) -> NDArray[np.float32]:
    """Average an image over squares, of whose pixels about every second one is read.

    Args:
        rgb: (H, W, 3).
        size: Pixels along a square's side.

    Returns:
        (H // size, W // size) float32 mean of the channels, 0 to 255.
    """
    height, width = rgb.shape[0] // size, rgb.shape[1] // size
    step = max(size // 2, 1)
    each = 3.0 * ((size + step - 1) // step) ** 2
    grey = np.empty((height, width), np.float32)
    values = rgb.reshape(len(rgb), -1)
    sums = np.empty(values.shape[1], np.int32)
    of_pixels, of_blocks = np.empty(rgb.shape[1], np.int32), np.empty(width, np.int32)
    for row in range(height):
        _widen(values[row * size], sums)
        for y in range(row * size + step, (row + 1) * size, step):
            _add(values[y], sums)
        _add_channels(sums, of_pixels)
        of_blocks[:] = 0
        for first in range(0, size, step):
            for column in range(width):
                of_blocks[column] += of_pixels[column * size + first]
        for column in range(width):
            grey[row, column] = of_blocks[column] / each
    return grey


@compiled
def _widen(values: NDArray[np.uint8], sums: NDArray[np.int32]) -> None:
    for n in range(len(sums)):
        sums[n] = values[n]


@compiled
def _add(values: NDArray[np.uint8], sums: NDArray[np.int32]) -> None:
    for n in range(len(sums)):
        sums[n] += np.int32(values[n])


@compiled
def _add_channels(sums: NDArray[np.int32], of_pixels: NDArray[np.int32]) -> None:
    for n in range(len(of_pixels)):
        of_pixels[n] = sums[3 * n] + sums[3 * n + 1] + sums[3 * n + 2]


@compiled
def _reduced(rgb: NDArray[np.uint8], size: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    grey = grey_blocks(rgb, size)
    height, width = grey.shape
    sums = np.zeros((height + 1, width + 1), np.float32)
    for row in range(height):
        along = 0.0
        for column in range(width):
            along += grey[row, column]
            sums[row + 1, column + 1] = sums[row, column + 1] + along
    rows, columns = min(THUMBNAIL, height), min(THUMBNAIL, width)
    thumbnail = np.empty((rows, columns), np.float32)
    for row in range(rows):
        top, bottom = row * height // rows, (row + 1) * height // rows
        for column in range(columns):
            left, right = column * width // columns, (column + 1) * width // columns
            thumbnail[row, column] = _mean(sums, top, bottom, left, right)
    for row in range(height):
        top, bottom = max(row - SURROUNDINGS, 0), min(row + SURROUNDINGS + 1, height)
        for column in range(width):
            left, right = max(column - SURROUNDINGS, 0), min(column + SURROUNDINGS + 1, width)
            grey[row, column] -= _mean(sums, top, bottom, left, right)
    return grey, thumbnail


@compiled
def _mean(sums: NDArray[np.float32], top: int, bottom: int, left: int, right: int) -> float:
    """Mean of a rectangle of the image that ``sums`` is the integral of."""
    total = sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left]
    return float(total / ((bottom - top) * (right - left)))


@compiled
def _correlated(
    rays: NDArray[np.float64],
    stride: int,
    transform: NDArray[np.float64],
    depth: NDArray[np.float32],
    pinhole: NDArray[np.float64],
    later_pinhole: NDArray[np.float64],
    detail: NDArray[np.float32],
    later_detail: NDArray[np.float32],
) -> tuple[float, float, int]:
    height, width = depth.shape
    size = height / len(detail)
    fx, fy, cx, cy = pinhole
    count = 0
    s_a, s_b, s_aa, s_bb, s_ab = 0.0, 0.0, 0.0, 0.0, 0.0
    for index in range(0, len(rays), stride):
        x, y, here = rays[index]
        away = (transform[2, 0] * x + transform[2, 1] * y + transform[2, 2]) * here
        away += transform[2, 3]
        if not away > 0.0:
            continue
        right = (transform[0, 0] * x + transform[0, 1] * y + transform[0, 2]) * here
        down = (transform[1, 0] * x + transform[1, 1] * y + transform[1, 2]) * here
        column = fx * (right + transform[0, 3]) / away + cx
        row = fy * (down + transform[1, 3]) / away + cy
        if not (-0.5 < column < width - 0.5 and -0.5 < row < height - 0.5):
            continue
        there = np.float64(depth[int(row + 0.5), int(column + 0.5)])
        if not abs(away - there) <= depth_tolerance(there):
            continue
        a = _at(detail, (row + 0.5) / size - 0.5, (column + 0.5) / size - 0.5)
        own_row = later_pinhole[1] * y + later_pinhole[3]
        own_column = later_pinhole[0] * x + later_pinhole[2]
        b = _at(later_detail, (own_row + 0.5) / size - 0.5, (own_column + 0.5) / size - 0.5)
        count += 1
        s_a += a
        s_b += b
        s_aa += a * a
        s_bb += b * b
        s_ab += a * b
    if count < 2:
        return 0.0, 0.0, count
    of_a, of_b = s_aa / count - (s_a / count) ** 2, s_bb / count - (s_b / count) ** 2
    both = s_ab / count - s_a * s_b / count**2
    least = max(min(of_a, of_b), 0.0)
    return both / np.sqrt(max(of_a * of_b, 1e-12)), np.sqrt(least), count


@compiled
def _at(image: NDArray[np.float32], row: float, column: float) -> float:
    """Interpolate bilinearly."""
    height, width = image.shape
    row = min(max(row, 0.0), height - 1.001)
    column = min(max(column, 0.0), width - 1.001)
    y, x = int(row), int(column)
    down, right = row - y, column - x
    y1, x1 = min(y + 1, height - 1), min(x + 1, width - 1)
    above = image[y, x] * (1.0 - right) + image[y, x1] * right
    below = image[y1, x] * (1.0 - right) + image[y1, x1] * right
    return float(above * (1.0 - down) + below * down)
