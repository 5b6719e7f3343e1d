# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where a depth camera sees nothing: surfaces that it grazes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

HALF_LOST = 75.0
"""Degrees from the normal at which half of the pixels have no depth."""
WIDTH = 4.0
"""Degrees of the logistic rise about it."""


def hole_probability(cosines: NDArray[np.floating]) -> NDArray[np.float32]:
    """Chance (...,) that a pixel has no depth, by the cosine between its ray and the normal.

    A structured-light camera loses its pattern on grazed surfaces: Nguyen et al., "Modeling Kinect
    sensor noise for improved 3D reconstruction and tracking", 3DIMPVT 2012, found the noise to
    grow without bound, and no data to speak of, beyond 70 to 80 degrees.

    Args:
        cosines: (H, W) between view and normal.
    """
    degrees = np.rad2deg(np.arccos(np.clip(np.asarray(cosines, np.float32), -1.0, 1.0)))
    chance = 1.0 / (1.0 + np.exp((HALF_LOST - degrees) / WIDTH))
    return np.asarray(chance, np.float32)
