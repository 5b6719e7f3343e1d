# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The shading of a surface under the light that it was seen in, or under an assumed one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.models.lightnet.shading import Shading, shading
from reflest_core.surface.observed_surface import ObservedSurface

USUAL_ALBEDO = 0.25
"""Mean diffuse albedo of SynBRDF's materials."""
ASSUMED_COVERAGE = 1e-3
"""Above 0, so that the assumed radiance counts; far below what any background shows."""


def surface_shading(
    surface: ObservedSurface, voxels: NDArray[np.int64], without: tuple[str, ...] = ()
) -> Shading:
    """The shading of ``voxels`` by ``surface.light``; by :func:`assumed_light` if none was seen.

    ``without``: see :func:`~reflest_core.models.lightnet.shading.shading`.
    """
    light = surface.light
    if light is None or not light.coverage.any():
        light = assumed_light(surface)
    return shading(surface, light, voxels, without)


def assumed_light(surface: ObservedSurface) -> ObservedLight:
    """Grey light from everywhere, as strong as would make the surface of usual albedo."""
    brightness = float(srgb.LINEAR[surface.colours].mean()) if len(surface.colours) else 0.0
    radiance = np.full((SIZE, SIZE, 3), brightness / USUAL_ALBEDO, np.float32)
    coverage = np.full((SIZE, SIZE), ASSUMED_COVERAGE, np.float32)
    return ObservedLight(radiance, coverage, np.zeros((SIZE, SIZE, 3), np.float32))
