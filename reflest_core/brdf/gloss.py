# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Pellacini's gloss: contrast c and distinctness d (Eq. 2), both ways (numpy or torch)."""

from __future__ import annotations

from typing import Any

import numpy as np
from array_api_compat import array_namespace

from reflest_core.brdf.lab import at_least, lab_to_rgb, luminance, rgb_to_lab
from reflest_core.brdf.parameters import (
    ALPHA,
    CONTRAST,
    DISTINCTNESS,
    LAB,
    RHO_D,
    RHO_S,
    LabCdParameters,
    WardParameters,
    WardVariant,
)

Array = Any

_SMALLEST = 1e-12
"""Keeps the slope of the cube root finite at 0."""


def contrast(rho_d_luminance: Array, rho_s: Array) -> Array:
    """Return the contrast of gloss ``c`` (Eq. 2).

    Args:
        rho_d_luminance: (...) Rec. 709 luminance of ``rho_d``.
        rho_s: (...) specular albedo.

    Returns:
        (...) ``c``.
    """
    return _cube_root(rho_s + rho_d_luminance / 2) - _cube_root(rho_d_luminance / 2)


def specular_strength(rho_d_luminance: Array, c: Array) -> Array:
    """Invert :func:`contrast`.

    Args:
        rho_d_luminance: (...) Rec. 709 luminance of ``rho_d``.
        c: (...) contrast of gloss.

    Returns:
        (...) ``rho_s``, clamped at 0.
    """
    xp = array_namespace(rho_d_luminance)
    cubed = (c + _cube_root(rho_d_luminance / 2)) ** 3
    return xp.clip(cubed - rho_d_luminance / 2, 0, None)


def ward_to_labcd(ward: Array) -> Array:
    """Convert Ward vectors to Lab and gloss.

    Args:
        ward: (..., 5) in the order of :data:`.parameters.PARAMETERS`.

    Returns:
        (..., 5) ``L, a, b, c, d``.
    """
    xp = array_namespace(ward)
    rho_d, rho_s, alpha = ward[..., RHO_D], ward[..., RHO_S], ward[..., ALPHA]
    c = contrast(luminance(rho_d), rho_s)
    gloss = xp.stack([c, 1 - alpha], axis=-1)
    return xp.concat([rgb_to_lab(rho_d), gloss], axis=-1)


def labcd_to_ward(labcd: Array) -> Array:
    """Convert Lab and gloss to Ward vectors.

    Args:
        labcd: (..., 5) ``L, a, b, c, d``.

    Returns:
        (..., 5) in the order of :data:`.parameters.PARAMETERS`; colours are not clipped.
    """
    xp = array_namespace(labcd)
    rho_d = lab_to_rgb(labcd[..., LAB])
    rho_s = specular_strength(xp.clip(luminance(rho_d), 0, None), labcd[..., CONTRAST])
    gloss = xp.stack([rho_s, 1 - labcd[..., DISTINCTNESS]], axis=-1)
    return xp.concat([rho_d, gloss], axis=-1)


def to_labcd(parameters: WardParameters) -> LabCdParameters:
    """Convert one Ward BRDF to Lab and gloss.

    Args:
        parameters: The BRDF.

    Returns:
        The same material as Lab, contrast and distinctness of gloss.
    """
    lightness, a, b, c, d = ward_to_labcd(np.array(parameters.vector)).tolist()
    return LabCdParameters((lightness, a, b), c, d)


def to_ward(
    parameters: LabCdParameters, variant: WardVariant = WardVariant.WARD_1992
) -> WardParameters:
    """Convert Lab and gloss to a Ward BRDF.

    Args:
        parameters: Lab and gloss.
        variant: The specular normalisation that the result states.

    Returns:
        The BRDF; colours outside the gamut are not clipped.
    """
    vector = np.array([*parameters.lab, parameters.c, parameters.d])
    red, green, blue, rho_s, alpha = labcd_to_ward(vector).tolist()
    return WardParameters((red, green, blue), rho_s, alpha, variant)


def _cube_root(x: Array) -> Array:
    """Cube root of ``x >= 0`` with a finite slope at 0."""
    return at_least(x, _SMALLEST) ** (1 / 3)
