# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The losses of section 3.2: E_d (Table 1) and the regulariser E_c (Eq. 4).

All are differentiable in torch; :func:`colour_constancy` also takes numpy arrays. RMSE_1 and RMSE_2
are one formula on two parameterisations, so they share :func:`parameter_distance`.
"""

from __future__ import annotations

from typing import Any

import torch
from array_api_compat import array_namespace

from reflest_core.brdf.half_angle import HalfAngleQuadrature
from reflest_core.brdf.parameters import ALPHA, RHO_D, RHO_S, WardVariant
from reflest_core.brdf.ward import evaluate

Array = Any

GAMMA = 2.4
"""The paper's plain gamma between 8-bit colour and radiance, used in Eq. 4 alone."""


def parameter_distance(
    estimate: torch.Tensor, truth: torch.Tensor, gloss_weight: float = 1.0
) -> torch.Tensor:
    """Return RMSE_1 or RMSE_2 of Table 1; the squares are summed, as the table prints them.

    Args:
        estimate: (B, 5) z-scored; RMSE_1 on Ward vectors, RMSE_2 on ``L, a, b, c, d``.
        truth: (B, 5) the same.
        gloss_weight: ``lambda_g`` of RMSE_2.

    Returns:
        (B,) distances.
    """
    squares = (estimate - truth) ** 2
    return squares[..., RHO_D].sum(-1) + gloss_weight * squares[..., RHO_S:].sum(-1)


def cube_root(
    estimate: torch.Tensor,
    truth: torch.Tensor,
    quadrature: HalfAngleQuadrature,
    variant: WardVariant = WardVariant.WARD_1992,
) -> torch.Tensor:
    """Return CubeRoot of Table 1.

    The cube root of the integral of ``|f - f_hat| cos theta_i`` over both hemispheres, mean over
    RGB.

    Args:
        estimate: (B, 5) Ward vectors, ``alpha`` above 0.
        truth: (B, 5) the same.
        quadrature: Nodes of the integral.
        variant: The specular normalisation.

    Returns:
        (B,) distances.
    """

    def brdf(ward: torch.Tensor) -> torch.Tensor:
        rho_d, rho_s, alpha = ward[:, None, RHO_D], ward[:, None, RHO_S], ward[:, None, ALPHA]
        value: torch.Tensor = evaluate(
            rho_d, rho_s, alpha, quadrature.omega_i, quadrature.omega_o, variant
        )
        return value

    difference = (brdf(estimate) - brdf(truth)).abs().mean(-1)
    integral = (difference * quadrature.weights).sum(-1)
    # The slope of the cube root is infinite where estimate and truth agree.
    return torch.clamp(integral, min=1e-9) ** (1 / 3)


def colour_constancy(rho_d: Array, rho_s: Array, foreground: Array, background: Array) -> Array:
    """Return E_c of Eq. 4.

    Args:
        rho_d: (..., 3) diffuse albedo.
        rho_s: (...) specular albedo.
        foreground: (..., W, 3) mean 8-bit colour F of each view in [0, 255]; NaN where unknown.
        background: (..., W, 3) the same for B. A view where either is NaN does not count.

    Returns:
        (...) the energy.
    """
    xp = array_namespace(rho_d, foreground)
    known = ~(xp.isnan(foreground) | xp.isnan(background))
    zero = xp.zeros_like(foreground)
    f = xp.where(known, foreground / 255, zero) ** GAMMA
    b = xp.where(known, background / 255, zero) ** GAMMA
    albedo = (rho_d + rho_s[..., None])[..., None, :]
    return xp.sum((albedo * b - f) ** 2, axis=(-2, -1))
