# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The microfacet lobe of glTF and UsdPreviewSurface, and the roughness that stands for Ward's.

Both formats shade with Trowbridge-Reitz (GGX) facets and Smith's masking; neither knows Ward.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardVariant

Array = NDArray[np.float64]

RATIO_KNOTS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
"""Ward's alpha at the columns of :data:`ALPHA_RATIO`."""

ALPHA_RATIO: dict[WardVariant, tuple[float, ...]] = {
    WardVariant.WARD_1992: (
        0.9248,
        0.9243,
        0.9199,
        0.9031,
        0.8705,
        0.8274,
        0.7812,
        0.7363,
        0.6945,
        0.6563,
        0.6217,
    ),
    WardVariant.BOUNDED_2010: (
        0.9248,
        0.9240,
        0.9189,
        0.9025,
        0.8725,
        0.8345,
        0.7950,
        0.7574,
        0.7231,
        0.6921,
        0.6643,
    ),
}
"""``alpha_ggx / alpha_ward``; ``python -m reflest_core.brdf.ggx_fit`` computes it anew."""


def ggx_alpha(alpha: float, variant: WardVariant) -> float:
    """GGX width in (0, 1] of the lobe nearest to Ward's of width ``alpha`` > 0.

    Nearest: :func:`reflest_core.brdf.ggx_fit.fit_ggx_alpha`, interpolated between knots. A GGX
    lobe has a longer tail, so the nearest one is narrower. Above ``alpha`` = 1 the last ratio
    holds.
    """
    ratio = float(np.interp(alpha, RATIO_KNOTS, ALPHA_RATIO[variant]))
    return min(alpha * ratio, 1.0)


def ggx_lobe(alpha: float, omega_i: Array, omega_o: Array) -> Array:
    """Specular BRDF (...), 1/sr, of unit reflectance: ``D V`` of glTF 2.0, Appendix B.3.2.

    ``omega_i``, ``omega_o``: (..., 3) unit vectors in the local frame; 0 below the surface.
    """
    cos_i, cos_o = omega_i[..., 2], omega_o[..., 2]
    above = (cos_i > 0) & (cos_o > 0)
    cos_i, cos_o = np.where(above, cos_i, 1.0), np.where(above, cos_o, 1.0)
    half = omega_i + omega_o
    across_squared = half[..., 0] ** 2 + half[..., 1] ** 2
    length_squared = np.where(above, across_squared + half[..., 2] ** 2, 1.0)
    # cos^2 theta_h (alpha^2 - 1) + 1 without its cancellation at the smallest alphas.
    spread = (across_squared + alpha**2 * half[..., 2] ** 2) / length_squared
    distribution = alpha**2 / (math.pi * spread**2)
    square = alpha**2
    masking_i = cos_o * np.sqrt(square + (1 - square) * cos_i**2)
    masking_o = cos_i * np.sqrt(square + (1 - square) * cos_o**2)
    value: Array = np.where(above, distribution / (2 * (masking_i + masking_o)), 0.0)
    return value
