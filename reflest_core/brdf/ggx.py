# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The microfacet lobe of glTF and UsdPreviewSurface, and the roughness that stands for Ward's.

Trowbridge-Reitz (GGX) facets with Smith's masking; asset formats shade with it, and not with Ward.
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
"""``alpha_ggx / alpha_ward``; ``python -m reflest_core.brdf.ggx_fit`` computes it."""


def ggx_alpha(alpha: float, variant: WardVariant) -> float:
    """Convert a Ward roughness to the width of the nearest GGX lobe.

    Nearest is what :func:`reflest_core.brdf.ggx_fit.fit_ggx_alpha` finds, interpolated between
    knots. A GGX lobe has a longer tail, so the nearest one is narrower. Above ``alpha`` = 1 the
    last ratio holds.

    Args:
        alpha: Ward's roughness, above 0.
        variant: The specular normalisation of the Ward lobe.

    Returns:
        GGX width in (0, 1].
    """
    ratio = float(np.interp(alpha, RATIO_KNOTS, ALPHA_RATIO[variant]))
    return min(alpha * ratio, 1.0)


def ggx_lobe(alpha: float, omega_i: Array, omega_o: Array) -> Array:
    """Evaluate a lobe of unit reflectance: ``D V`` of glTF 2.0, Appendix B.3.2.

    Args:
        alpha: GGX width.
        omega_i: (..., 3) unit directions of incidence, local frame.
        omega_o: (..., 3) unit directions to the camera, local frame.

    Returns:
        (...) in 1/sr; 0 below the surface.
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


def sample_ggx(alpha: float, omega_o: Array, u: Array) -> Array:
    """Draw directions of incidence by half vectors in proportion to ``D cos theta_h``.

    Source: Walter et al. 2007, Eq. 35. A direction may fall below the surface.

    Args:
        alpha: GGX width.
        omega_o: (..., 3) unit directions to the camera, local frame.
        u: (..., 2) uniform in [0, 1).

    Returns:
        (..., 3) unit directions.
    """
    share, turn = u[..., 0], 2 * math.pi * u[..., 1]
    tangent = alpha * np.sqrt(share / (1 - share))
    cos_h = 1 / np.sqrt(1 + tangent**2)
    sin_h = tangent * cos_h
    half = np.stack([sin_h * np.cos(turn), sin_h * np.sin(turn), cos_h], axis=-1)
    mirrored: Array = 2 * np.sum(half * omega_o, axis=-1)[..., None] * half - omega_o
    return mirrored


def ggx_density(alpha: float, omega_i: Array, omega_o: Array) -> Array:
    """Density of :func:`sample_ggx`.

    Args:
        alpha: GGX width.
        omega_i: (..., 3) unit directions of incidence, local frame.
        omega_o: (..., 3) unit directions to the camera, local frame.

    Returns:
        (...) per steradian of ``omega_i``.
    """
    half = omega_i + omega_o
    length = np.linalg.norm(half, axis=-1)
    cos_h = half[..., 2] / length
    tan_squared = 1 / cos_h**2 - 1
    distribution = alpha**2 / (math.pi * cos_h**4 * (alpha**2 + tan_squared) ** 2)
    value: Array = distribution * np.abs(cos_h) / (2 * length)
    return value
