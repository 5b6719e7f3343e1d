# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Apparent albedos, colour over irradiance, and the space in which two of them are compared."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import rgb_to_lab

LIGHTNESS = 0.5
"""Weight of L beside a and b: the light's errors are mostly of brightness."""
HIGHEST_ALBEDO = 1.5
"""Ratios of colour to irradiance are held here, where the light was underestimated."""
LEAST_IRRADIANCE = 1e-3
"""``E / pi`` in units of the sensor's white."""


def apparent_albedo(
    colours: NDArray[np.float32], irradiance: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Divide diffuse colours by the irradiance.

    Args:
        colours: (N, 3) linear.
        irradiance: (N, 3) ``E / pi`` in the colours' units.

    Returns:
        (N, 3) albedos, above 1 where the light was underestimated.
    """
    return np.asarray(colours / np.maximum(irradiance, np.float32(LEAST_IRRADIANCE)))


def albedo_to_lab(albedo: NDArray[np.float32]) -> NDArray[np.float64]:
    """Convert apparent albedos to Lab with lightness halved.

    Args:
        albedo: (N, 3) linear; held to [0, :data:`HIGHEST_ALBEDO`].

    Returns:
        (N, 3) L / 2, a, b.
    """
    lab = np.asarray(rgb_to_lab(np.clip(albedo.astype(np.float64), 0.0, HIGHEST_ALBEDO)))
    lab[:, 0] *= LIGHTNESS
    return lab
