# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Materials drawn in OpenSurfaces' space: an sRGB colour, contrast and distinctness of gloss."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass

import numpy as np

from reflest_core.brdf import gloss
from reflest_core.brdf.lab import luminance
from reflest_core.brdf.parameters import WardParameters, WardVariant

DOI_LEVELS = 15
"""OpenSurfaces' distinctness-of-image slider runs from 0 (rough) to 15 (sharp)."""


@dataclass(frozen=True)
class OpenSurfacesLabel:
    """What an annotator sets: ``colour`` sRGB in [0, 1], ``contrast`` in [0, 1], ``doi`` 0..15."""

    colour: tuple[float, float, float]
    contrast: float
    doi: float


def to_ward(
    label: OpenSurfacesLabel, variant: WardVariant = WardVariant.WARD_1992
) -> WardParameters:
    """Compute the Ward parameters (linear sRGB) that OpenSurfaces renders for a label.

    ``rho_d`` is proportional to the colour with ``max(rho_d) = max(colour)^3``;
    ``alpha = 0.001 + (15 - doi) * 0.2 / 15``; ``rho_s`` inverts Eq. 2's contrast
    ``c = cbrt(rho_s + rho_d / 2) - cbrt(rho_d / 2)`` with ``rho_d`` its Rec. 709 luminance. Both
    are divided by ``max(rho_d) + rho_s`` where that passes 1.

    Args:
        label: colour, contrast and distinctness of gloss.
        variant: of Ward's model.
    """
    colour = np.asarray(label.colour, dtype=np.float64)
    value = colour.max()
    rho_d = colour * value**2
    rho_s = float(gloss.specular_strength(luminance(rho_d), np.float64(label.contrast)))
    excess = max(float(rho_d.max()) + rho_s, 1.0)
    red, green, blue = (float(albedo) for albedo in rho_d / excess)
    alpha = 0.001 + (DOI_LEVELS - label.doi) * 0.2 / DOI_LEVELS
    return WardParameters((red, green, blue), rho_s / excess, alpha, variant)


def draw_label(rng: np.random.Generator) -> OpenSurfacesLabel:
    """Draw a label: any hue, mostly moderate saturation, all lightnesses, all glosses.

    Two materials in ten are matte; the rest have a contrast of any size, small ones more often,
    as the annotated surfaces of OpenSurfaces do.

    Args:
        rng: random numbers; the same state draws the same.
    """
    saturation = rng.beta(1.2, 1.8)
    colour = colorsys.hsv_to_rgb(rng.uniform(), saturation, rng.beta(3.0, 1.5))
    is_matte = rng.uniform() < 0.2
    contrast = rng.beta(1.0, 12.0) if is_matte else rng.beta(1.2, 2.0)
    return OpenSurfacesLabel(colour, float(contrast), float(rng.uniform(0.0, DOI_LEVELS)))


def draw_material(
    rng: np.random.Generator, variant: WardVariant = WardVariant.WARD_1992
) -> WardParameters:
    """Draw a material; the same generator state gives the same one.

    Args:
        rng: random numbers; the same state draws the same.
        variant: of Ward's model.
    """
    return to_ward(draw_label(rng), variant)
