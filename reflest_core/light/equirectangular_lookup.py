# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Radiance that an environment map sends from a direction."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def radiance_from(
    environment: NDArray[np.float32], directions: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Radiance (R, C) seen along unit ``directions`` (R, 3), bilinear between texel centres.

    ``environment`` (H, W, C) in the convention of :mod:`.equirectangular`: z up, the zenith in row
    0, azimuth ``phi`` at the column ``0.5 - phi / (2 pi)`` of the width.
    """
    height, width = environment.shape[:2]
    x, y, z = directions.astype(np.float64).T
    column = (0.5 - np.arctan2(y, x) / (2.0 * np.pi)) * width - 0.5
    row = np.clip(np.arccos(np.clip(z, -1.0, 1.0)) / np.pi * height - 0.5, 0.0, height - 1.0)
    left, top = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
    across, down = (column - left)[:, None], (row - top)[:, None]
    bottom = np.minimum(top + 1, height - 1)
    upper, lower = (
        environment[line, left % width] * (1.0 - across)
        + environment[line, (left + 1) % width] * across
        for line in (top, bottom)
    )
    return np.asarray(upper * (1.0 - down) + lower * down, np.float32)
