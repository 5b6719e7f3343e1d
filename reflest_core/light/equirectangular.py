# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Directions as an equirectangular (lat-long) image, in the world frame.

z is up: row 0 touches +z, the last row -z. A direction of azimuth ``phi = atan2(y, x)`` lies at
the column ``u = 0.5 - phi / (2 pi)`` (a fraction of the width): +x is in the middle, +y a quarter
of the width to its left, -y to its right, -x at both edges. So the image shows what somebody at its
centre sees, unmirrored; OpenEXR's lat-long maps are handed the same way.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def equirectangular_directions(height: int) -> NDArray[np.float64]:
    """Unit vectors (height, 2 * height, 3) of the pixels' centres."""
    polar = (np.arange(height) + 0.5) / height * np.pi
    azimuth = (0.5 - (np.arange(2 * height) + 0.5) / (2 * height)) * 2.0 * np.pi
    sine = np.sin(polar)[:, None]
    return np.stack(
        np.broadcast_arrays(sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(polar)[:, None]),
        axis=-1,
    )


def equirectangular_solid_angles(height: int) -> NDArray[np.float64]:
    """Solid angle (height, 1) in steradians of a pixel in each row; all pixels make 4 pi."""
    edges = np.cos(np.linspace(0.0, np.pi, height + 1))
    return (edges[:-1] - edges[1:])[:, None] * np.pi / height
