# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Pellacini's gloss: contrast c and distinctness d (Eq. 2), both ways (numpy or torch)."""

from __future__ import annotations

from typing import Any

import numpy as np
from array_api_compat import array_namespace

from reflest_core.brdf.lab import lab_to_rgb, luminance, rgb_to_lab
from reflest_core.brdf.parameters import LabCdParameters, WardParameters, WardVariant

Array = Any

_SMALLEST = 1e-12
"""Keeps the slope of the cube root finite at 0."""


def contrast(rho_d_luminance: Array, rho_s: Array) -> Array:
    """``c`` (...) from the Rec. 709 luminance of ``rho_d`` and ``rho_s`` (...)."""
    return _cube_root(rho_s + rho_d_luminance / 2) - _cube_root(rho_d_luminance / 2)


def specular_strength(rho_d_luminance: Array, c: Array) -> Array:
    """``rho_s`` (...) from ``c``, the inverse of :func:`contrast`, clamped at 0."""
    xp = array_namespace(rho_d_luminance)
    cubed = (c + _cube_root(rho_d_luminance / 2)) ** 3
    return xp.clip(cubed - rho_d_luminance / 2, 0, None)


def ward_to_labcd(ward: Array) -> Array:
    """(..., 5) of ``rho_d`` (3), ``rho_s``, ``alpha`` to (..., 5) of ``L, a, b, c, d``."""
    xp = array_namespace(ward)
    rho_d, rho_s, alpha = ward[..., :3], ward[..., 3], ward[..., 4]
    c = contrast(luminance(rho_d), rho_s)
    gloss = xp.stack([c, 1 - alpha], axis=-1)
    return xp.concat([rgb_to_lab(rho_d), gloss], axis=-1)


def labcd_to_ward(labcd: Array) -> Array:
    """(..., 5) of ``L, a, b, c, d`` to (..., 5) of ``rho_d`` (3), ``rho_s``, ``alpha``."""
    xp = array_namespace(labcd)
    rho_d = lab_to_rgb(labcd[..., :3])
    rho_s = specular_strength(xp.clip(luminance(rho_d), 0, None), labcd[..., 3])
    gloss = xp.stack([rho_s, 1 - labcd[..., 4]], axis=-1)
    return xp.concat([rho_d, gloss], axis=-1)


def to_labcd(parameters: WardParameters) -> LabCdParameters:
    """The Lab/c,d twin of one Ward BRDF."""
    vector = np.array([*parameters.rho_d, parameters.rho_s, parameters.alpha])
    lightness, a, b, c, d = ward_to_labcd(vector).tolist()
    return LabCdParameters((lightness, a, b), c, d)


def to_ward(
    parameters: LabCdParameters, variant: WardVariant = WardVariant.WARD_1992
) -> WardParameters:
    """The Ward BRDF of Lab/c,d values; colours outside the gamut are not clipped."""
    vector = np.array([*parameters.lab, parameters.c, parameters.d])
    red, green, blue, rho_s, alpha = labcd_to_ward(vector).tolist()
    return WardParameters((red, green, blue), rho_s, alpha, variant)


def _cube_root(x: Array) -> Array:
    """Cube root of ``x >= 0`` with a finite slope at 0."""
    xp = array_namespace(x)
    return xp.clip(x, _SMALLEST, None) ** (1 / 3)
