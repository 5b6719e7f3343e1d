# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Fits a GGX lobe to a Ward lobe: ``python -m reflest_core.brdf.ggx_fit`` prints the table.

Both lobes are compared where light and camera coincide, for there the half angle alone varies: no
Fresnel term has a part in it, and the horizon, where Ward 1992 diverges, little.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from reflest_core.brdf.ggx import RATIO_KNOTS, Array, ggx_lobe
from reflest_core.brdf.parameters import WardVariant
from reflest_core.brdf.ward import specular

NODES = 4000
SMALLEST_ALPHA = 0.001
"""Stands for the knot at 0, to which the ratio converges."""


@dataclass(frozen=True)
class LobeFit:
    """The GGX lobe that is nearest to a Ward lobe.

    Attributes:
        alpha: Width of the GGX lobe.
        residual: Its RMS difference over the RMS of Ward's lobe.
    """

    alpha: float
    residual: float


def fit_ggx_alpha(alpha: float, variant: WardVariant) -> LobeFit:
    """Find the GGX lobe of the same reflectance with the least cosine-weighted RMS difference.

    The mean is over half vectors of the hemisphere, weighed by ``cos theta_i cos theta_o``, which
    is ``cos^2 theta_h`` here.

    Args:
        alpha: Ward's roughness.
        variant: The specular normalisation of the Ward lobe.

    Returns:
        The nearest lobe.
    """
    directions, weights = _half_vectors(alpha)
    ward = specular(np.array(1.0), np.array(alpha), directions, directions, variant)

    def difference(log_ratio: float) -> float:
        lobe = ggx_lobe(alpha * math.exp(log_ratio), directions, directions)
        return _norm(lobe - ward, weights)

    found = minimize_scalar(
        difference, bounds=(-1.5, 0.5), method="bounded", options={"xatol": 1e-8}
    )
    fitted = alpha * math.exp(found.x)
    return LobeFit(fitted, float(found.fun) / _norm(ward, weights))


def _half_vectors(alpha: float) -> tuple[Array, Array]:
    """Directions (NODES, 3) spaced by log tan theta_h around ``alpha``, and their weights."""
    edges = np.concatenate([[0.0], alpha * np.geomspace(1e-3, 1e4, NODES)])
    tangent = (edges[1:] + edges[:-1]) / 2
    cosine = 1 / np.sqrt(1 + tangent**2)
    sine = tangent * cosine
    solid_angle = 2 * math.pi * sine * cosine**2 * np.diff(edges)
    directions = np.stack([sine, np.zeros_like(sine), cosine], axis=-1)
    return directions, solid_angle * cosine**2


def _norm(lobe: Array, weights: Array) -> float:
    return math.sqrt(float(np.sum(weights * lobe**2)))


def main() -> None:
    """Print a row for each knot: ratio and residual of both variants."""
    print("alpha  " + "  ".join(f"{variant.value:>26}" for variant in WardVariant))
    for knot in RATIO_KNOTS:
        alpha = max(knot, SMALLEST_ALPHA)
        fits = [fit_ggx_alpha(alpha, variant) for variant in WardVariant]
        cells = [f"ratio {fit.alpha / alpha:.4f} residual {fit.residual:.3f}" for fit in fits]
        print(f"{knot:5.1f}  " + "  ".join(cells))


if __name__ == "__main__":
    main()
