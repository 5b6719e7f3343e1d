# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Ward parameters that a surface can have, from those that a network gave."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import ALPHA, RHO_D, RHO_S, SMALLEST_ALPHA


def physical_ward(ward: NDArray[np.float64]) -> NDArray[np.float64]:
    """Clip Ward parameters to the nearest physical values.

    Each value is clipped to its range; both albedos are divided by ``max(rho_d) + rho_s`` where
    that passes 1.

    Args:
        ward: (5,) ``rho_d`` (3, linear sRGB), ``rho_s``, ``alpha``.

    Returns:
        (5,) the same, physical.
    """
    rho_d = np.clip(ward[RHO_D], 0.0, 1.0)
    rho_s = max(float(ward[RHO_S]), 0.0)
    alpha = max(float(ward[ALPHA]), SMALLEST_ALPHA)
    energy = max(float(rho_d.max()) + rho_s, 1.0)
    return np.array([*(rho_d / energy), rho_s / energy, alpha])
