# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Ward's material in the terms of glTF 2.0, UsdPreviewSurface and OpenPBR.

The mapping, with ``f = base (1 - F) / pi + F lobe`` and a GGX lobe:

- ``roughness = sqrt(alpha_ggx)``, as the formats define it; ``alpha_ggx`` is
  :func:`reflest_core.brdf.ggx.ggx_alpha`, the nearest in RMS, times :data:`NARROWER`.
- ``F`` at normal incidence (F0) is ``rho_s`` times Ward's mean albedo over that of the GGX lobe, so
  that both send as much light to all sides together. For the bounded variant that factor is nearly
  1; for Ward 1992, which loses light towards the horizon, about 2/3.
- ``base = rho_d / (1 - F0)``, which gives back ``rho_d`` after the facets took their share.
- Nothing is metal: Ward's highlight has no colour.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.ggx import RATIO_KNOTS, ggx_alpha
from reflest_core.brdf.parameters import WardParameters, WardVariant

NARROWER = 0.7
"""GGX has a tail, which the eye sees more than RMS does. With this times the RMS fit's width the
spheres of :mod:`reflest_core.evaluation.pictures.exported_spheres` have the least mean FLIP."""
ENERGY_RATIO: dict[WardVariant, tuple[float, ...]] = {
    WardVariant.WARD_1992: (
        0.6667,
        0.6595,
        0.6348,
        0.5973,
        0.5527,
        0.5053,
        0.4587,
        0.4147,
        0.3747,
        0.3387,
        0.3067,
    ),
    WardVariant.BOUNDED_2010: (
        1.0000,
        0.9857,
        0.9587,
        0.9268,
        0.8916,
        0.8538,
        0.8150,
        0.7767,
        0.7399,
        0.7050,
        0.6724,
    ),
}
""":func:`energy_ratio` at :data:`~reflest_core.brdf.ggx.RATIO_KNOTS`; a test integrates it."""


@dataclass(frozen=True)
class MicrofacetMaterial:
    """A dielectric of GGX facets.

    Attributes:
        base_colour: Linear sRGB in [0, 1].
        f0: Reflectance of a facet at normal incidence.
        roughness: In (0, 1], the square root of the GGX width.
    """

    base_colour: tuple[float, float, float]
    f0: float
    roughness: float

    @staticmethod
    def from_ward(ward: WardParameters) -> MicrofacetMaterial:
        """The nearest such material.

        Args:
            ward: The material.
        """
        f0 = min(ward.rho_s * energy_ratio(ward.alpha, ward.variant), 1.0)
        red, green, blue = base_colour(np.array(ward.rho_d), np.array(f0)).tolist()
        return MicrofacetMaterial(
            (red, green, blue), f0, math.sqrt(ggx_width(ward.alpha, ward.variant))
        )


def ggx_width(alpha: float, variant: WardVariant) -> float:
    """Width of the GGX lobe that looks most like Ward's.

    Args:
        alpha: Ward's roughness.
        variant: The specular normalisation of the Ward lobe.

    Returns:
        ``alpha`` of GGX, in (0, 1].
    """
    return NARROWER * ggx_alpha(alpha, variant)


def energy_ratio(alpha: float, variant: WardVariant) -> float:
    """Mean albedo of Ward's specular lobe over that of the GGX lobe that stands for it.

    The mean is over directions to the camera, weighted by their cosine (bihemispherical albedo).

    Args:
        alpha: Ward's roughness.
        variant: The specular normalisation of the Ward lobe.
    """
    return float(np.interp(alpha, RATIO_KNOTS, ENERGY_RATIO[variant]))


def base_colour(rho_d: NDArray[np.floating], f0: NDArray[np.floating]) -> NDArray[np.float64]:
    """The base colour that gives ``rho_d`` back after the facets took their share.

    Args:
        rho_d: (..., 3) linear sRGB.
        f0: (...) or (..., 1), which broadcasts against ``rho_d``.

    Returns:
        (..., 3) linear sRGB in [0, 1]; black for a mirror, which leaves nothing to the base.
    """
    left = 1.0 - np.asarray(f0, np.float64)
    colour = np.asarray(rho_d, np.float64) / np.where(left > 0.0, left, 1.0)
    return np.where(left > 0.0, np.minimum(colour, 1.0), 0.0)
