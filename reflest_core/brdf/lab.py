# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""CIE L*a*b* of *linear* Rec. 709 reflectance under D65, 2 degree observer (numpy or torch)."""

from __future__ import annotations

from typing import Any

import numpy as np
from array_api_compat import array_namespace
from numpy.typing import NDArray

Array = Any

PRIMARIES_XY = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
"""Chromaticities of the Rec. 709 red, green and blue."""
WHITE_XY = (0.3127, 0.3290)
"""Chromaticity of D65."""

_DELTA = 6 / 29


def _xyz_of_chromaticity(x: float, y: float) -> NDArray[np.float64]:
    return np.array([x / y, 1.0, (1 - x - y) / y])


def _rgb_to_xyz_matrix() -> NDArray[np.float64]:
    """(3, 3): primaries scaled so that RGB (1, 1, 1) is the white point with Y = 1."""
    primaries = np.stack([_xyz_of_chromaticity(*xy) for xy in PRIMARIES_XY], axis=1)
    scale = np.linalg.solve(primaries, _xyz_of_chromaticity(*WHITE_XY))
    matrix: NDArray[np.float64] = primaries * scale
    return matrix


RGB_TO_XYZ = _rgb_to_xyz_matrix()
XYZ_TO_RGB = np.linalg.inv(RGB_TO_XYZ)
WHITE_XYZ = _xyz_of_chromaticity(*WHITE_XY)
_RGB_TO_RELATIVE = (RGB_TO_XYZ / WHITE_XYZ[:, None]).T
"""(3, 3): a row of RGB to a row of XYZ over white's."""
LUMINANCE_WEIGHTS = RGB_TO_XYZ[1]
"""Rec. 709 luminance of linear RGB: about (0.2126, 0.7152, 0.0722)."""


def constant_like(values: NDArray[np.float64], like: Array) -> Array:
    """Convert constants to the kind of another array.

    Args:
        values: The constants.
        like: A numpy array or torch tensor.

    Returns:
        ``values`` as an array of the kind, type and device of ``like``.
    """
    xp = array_namespace(like)
    if isinstance(like, np.ndarray):
        return xp.asarray(values, dtype=like.dtype)
    return xp.asarray(values, dtype=like.dtype, device=like.device)


def at_least(values: Array, least: float) -> Array:
    """Raise values to a least one.

    Args:
        values: (...) of any kind.
        least: The bound.

    Returns:
        (...) as ``xp.clip`` gives them, which takes ten times as long for NumPy's small arrays.
    """
    if isinstance(values, (np.ndarray, np.generic)):
        return np.maximum(values, least)
    return array_namespace(values).clip(values, least, None)


def luminance(rgb: Array) -> Array:
    """Return Rec. 709 luminance.

    Args:
        rgb: (..., 3) linear RGB.

    Returns:
        (...) luminance.
    """
    xp = array_namespace(rgb)
    return xp.sum(rgb * constant_like(LUMINANCE_WEIGHTS, rgb), axis=-1)


def rgb_to_lab(rgb: Array) -> Array:
    """Convert linear RGB to CIE L*a*b* under D65/2 degrees; differentiable at 0.

    Args:
        rgb: (..., 3) linear RGB in [0, 1].

    Returns:
        (..., 3) L* in [0, 100], a*, b*.
    """
    xp = array_namespace(rgb)
    relative = rgb @ constant_like(_RGB_TO_RELATIVE, rgb)
    root = at_least(relative, _DELTA**3) ** (1 / 3)
    f = xp.where(relative > _DELTA**3, root, relative / (3 * _DELTA**2) + 4 / 29)
    fx, fy, fz = f[..., 0], f[..., 1], f[..., 2]
    return xp.stack([116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)], axis=-1)


def lab_to_rgb(lab: Array) -> Array:
    """Convert CIE L*a*b* to linear RGB.

    Args:
        lab: (..., 3) L*, a*, b*.

    Returns:
        (..., 3) linear RGB, not clipped to the gamut.
    """
    xp = array_namespace(lab)
    fy = (lab[..., 0] + 16) / 116
    f = xp.stack([fy + lab[..., 1] / 500, fy, fy - lab[..., 2] / 200], axis=-1)
    relative = xp.where(f > _DELTA, f**3, 3 * _DELTA**2 * (f - 4 / 29))
    return relative @ constant_like((XYZ_TO_RGB * WHITE_XYZ[None, :]).T, lab)
