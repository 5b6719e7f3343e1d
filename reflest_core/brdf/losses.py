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
from reflest_core.brdf.parameters import WardVariant
from reflest_core.brdf.ward import evaluate

Array = Any

GAMMA = 2.4
"""The paper's plain gamma between 8-bit colour and radiance, used in Eq. 4 alone."""


def parameter_distance(
    estimate: torch.Tensor, truth: torch.Tensor, gloss_weight: float = 1.0
) -> torch.Tensor:
    """RMSE_1 or RMSE_2 of Table 1, (B,), on z-scored parameters (B, 5).

    RMSE_1: columns ``rho_d`` (3), ``rho_s``, ``alpha``. RMSE_2: ``L, a, b, c, d``, where
    ``gloss_weight`` is ``lambda_g``. The squares are summed, as Table 1 prints them.
    """
    squares = (estimate - truth) ** 2
    return squares[..., :3].sum(-1) + gloss_weight * squares[..., 3:].sum(-1)


def cube_root(
    estimate: torch.Tensor,
    truth: torch.Tensor,
    quadrature: HalfAngleQuadrature,
    variant: WardVariant = WardVariant.WARD_1992,
) -> torch.Tensor:
    """CubeRoot of Table 1, (B,), on Ward parameters (B, 5), ``alpha`` > 0.

    Cube root of the integral of ``|f - f_hat| cos theta_i`` over both hemispheres, mean over RGB.
    """

    def brdf(ward: torch.Tensor) -> torch.Tensor:
        rho_d, rho_s, alpha = ward[:, None, :3], ward[:, None, 3], ward[:, None, 4]
        value: torch.Tensor = evaluate(
            rho_d, rho_s, alpha, quadrature.omega_i, quadrature.omega_o, variant
        )
        return value

    difference = (brdf(estimate) - brdf(truth)).abs().mean(-1)
    integral = (difference * quadrature.weights).sum(-1)
    # The slope of the cube root is infinite where estimate and truth agree.
    return torch.clamp(integral, min=1e-9) ** (1 / 3)


def colour_constancy(rho_d: Array, rho_s: Array, foreground: Array, background: Array) -> Array:
    """E_c of Eq. 4, (...), for ``rho_d`` (..., 3), ``rho_s`` (...).

    ``foreground``, ``background``: mean 8-bit colours F and B of each view (..., W, 3) in [0, 255];
    a view where either is NaN (no such pixels) does not count.
    """
    xp = array_namespace(rho_d, foreground)
    known = ~(xp.isnan(foreground) | xp.isnan(background))
    zero = xp.zeros_like(foreground)
    f = xp.where(known, foreground / 255, zero) ** GAMMA
    b = xp.where(known, background / 255, zero) ** GAMMA
    albedo = (rho_d + rho_s[..., None])[..., None, :]
    return xp.sum((albedo * b - f) ** 2, axis=(-2, -1))
