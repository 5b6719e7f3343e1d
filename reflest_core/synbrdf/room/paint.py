# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What walls and furniture are painted with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

TEXELS = 48
"""Along each edge of a painted panel."""
PATTERN_SHARES = {"plain": 0.45, "stripes": 0.15, "tiles": 0.15, "pictures": 0.25}


def draw_paint(
    rng: np.random.Generator, brightness: tuple[float, float], chroma: float
) -> NDArray[np.float32]:
    """Draw an albedo: plain or patterned, a little uneven.

    Args:
        rng: random numbers; the same state draws the same.
        brightness: range of the ground colour.
        chroma: standard deviation of the logarithms of its channels.

    Returns:
        (TEXELS, TEXELS, 3) linear sRGB.
    """
    ground = rng.uniform(*brightness) * np.exp(rng.normal(0.0, chroma, 3))
    albedo = np.tile(ground, (TEXELS, TEXELS, 1))
    pattern = rng.choice(list(PATTERN_SHARES), p=list(PATTERN_SHARES.values()))
    other = rng.uniform(0.04, 0.85) * np.exp(rng.normal(0.0, 0.3, 3))
    row, column = np.indices((TEXELS, TEXELS))
    if pattern == "stripes":
        width = int(rng.integers(2, 12))
        albedo[((row if rng.uniform() < 0.5 else column) // width) % 2 == 1] = other
    elif pattern == "tiles":
        width = int(rng.integers(3, 12))
        albedo[(row // width + column // width) % 2 == 1] = other
    elif pattern == "pictures":
        for _ in range(int(rng.integers(1, 6))):
            top, left = rng.integers(0, TEXELS - 6, 2)
            height, width = rng.integers(4, TEXELS // 2, 2)
            colour = rng.uniform(0.03, 0.85) * np.exp(rng.normal(0.0, 0.4, 3))
            albedo[top : top + height, left : left + width] = colour
    texture = gaussian_filter(rng.normal(size=(TEXELS, TEXELS)), rng.uniform(0.6, 4.0))
    uneven = 1.0 + rng.uniform(0.0, 0.2) * texture / texture.std()
    return np.asarray(np.clip(albedo * uneven[..., None], 0.01, 0.9), np.float32)
