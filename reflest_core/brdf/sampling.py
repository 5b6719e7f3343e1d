# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Importance sampling of the Ward lobe through its half vector (Ward 1992, Walter 2005).

Numpy or torch, like :mod:`reflest_core.brdf.ward`.
"""

from __future__ import annotations

import math
from typing import Any

from array_api_compat import array_namespace

from reflest_core.brdf.parameters import WardVariant

Array = Any


def sample_specular(alpha: Array, omega_o: Array, u: Array) -> Array:
    """Incident directions (..., 3) from ``u`` (..., 2) uniform in [0, 1).

    ``tan theta_h = alpha sqrt(-ln(1 - u_0))``, ``phi_h = 2 pi u_1``; ``omega_o`` is mirrored about
    the half vector. A direction may fall below the surface: there the BRDF is 0.
    """
    xp = array_namespace(omega_o, u)
    tan_h = alpha * xp.sqrt(-xp.log1p(-u[..., 0]))
    cos_h = 1 / xp.sqrt(1 + tan_h**2)
    sin_h = tan_h * cos_h
    phi = 2 * math.pi * u[..., 1]
    half = xp.stack([sin_h * xp.cos(phi), sin_h * xp.sin(phi), cos_h], axis=-1)
    return 2 * xp.sum(half * omega_o, axis=-1)[..., None] * half - omega_o


def specular_density(alpha: Array, omega_i: Array, omega_o: Array) -> Array:
    """Density (...) of :func:`sample_specular` per steradian of ``omega_i``."""
    xp = array_namespace(omega_i, omega_o)
    half = omega_i + omega_o
    length = xp.sqrt(xp.sum(half * half, axis=-1))
    cos_h = half[..., 2] / length
    half_dot_o = length / 2
    tan_squared = 1 / cos_h**2 - 1
    # The half vector carries Ward's Gaussian of tan theta_h; the mirror map has Jacobian 1/(4 h.o).
    density_h = xp.exp(-tan_squared / alpha**2) / (math.pi * alpha**2 * cos_h**3)
    return xp.where(cos_h > 0, density_h / (4 * half_dot_o), xp.zeros_like(density_h))


def specular_weight(
    rho_s: Array, omega_i: Array, omega_o: Array, variant: WardVariant = WardVariant.WARD_1992
) -> Array:
    """``f_s cos theta_i / density`` (...) of a sampled direction; free of ``alpha``."""
    xp = array_namespace(omega_i, omega_o)
    cos_i, cos_o = omega_i[..., 2], omega_o[..., 2]
    above = (cos_i > 0) & (cos_o > 0)
    one = xp.ones_like(cos_i * cos_o)
    half = omega_i + omega_o
    length = xp.sqrt(xp.sum(half * half, axis=-1))
    cos_h, half_dot_o = half[..., 2] / length, length / 2
    safe_cos_i, safe_cos_o = xp.where(above, cos_i, one), xp.where(above, cos_o, one)
    if variant is WardVariant.WARD_1992:
        weight = half_dot_o * cos_h**3 * xp.sqrt(safe_cos_i / safe_cos_o)
    else:
        weight = safe_cos_i / (xp.where(above, half_dot_o * cos_h, one))
    return xp.where(above, rho_s * weight, xp.zeros_like(weight))
