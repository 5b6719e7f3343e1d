# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Normals and positions of a surface that was fused from real depth, not modelled.

The figures are what ``reflest synbrdf measure fusion`` finds with the estimator's ``Scan`` at 5 mm,
a Kinect's depth and a tracker's poses (docs/synbrdf.md).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.realism.settings import Realism

TILT = 2.15
"""Degrees, median over points of a normal's stddev on both axes of the tangent plane."""
TILT_SPREAD = 0.5
"""Stddev over points of the logarithm of that stddev: creases and rims are far worse."""
OFFSET = 0.001
"""Metres, stddev of a position along its normal."""


def fused(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    realism: Realism,
    rng: np.random.Generator,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Positions and unit normals (V, 3) with the errors that fusion was measured to leave.

    Args:
        positions: (V, 3) metres.
        normals: (V, 3) unit.
        realism: which faults, and how strong.
        rng: random numbers; the same state draws the same.
    """
    degree = realism.normal_noise * rng.uniform()
    count = len(normals)
    spread = np.exp(TILT_SPREAD * rng.standard_normal((count, 1), np.float32))
    tilt = np.float32(np.deg2rad(TILT) * degree) * spread
    aside = rng.standard_normal((count, 3), np.float32)
    aside -= np.einsum("ij,ij->i", aside, normals)[:, None] * normals
    tilted = normals + np.tan(np.minimum(tilt, 0.3)) * aside
    tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
    offset = np.float32(OFFSET * degree) * rng.standard_normal((count, 1), np.float32)
    return positions + offset * normals, tilted.astype(np.float32)
