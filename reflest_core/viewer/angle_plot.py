# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Observations of a place over angle, beside what the model predicts for the same views."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.viewer.lights import Light
from reflest_core.viewer.shading import Shading

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Of linear sRGB (Rec. 709)."""


@dataclass(frozen=True)
class AnglePlot:
    """Luminance over the angle between the view and the mirrored brightest light.

    Attributes:
        degrees: (K,) rising.
        observed: (K,) linear luminance, 1 at the camera's white; of clipped colours a lower bound.
        model: (K,) what the material gives in the estimated light.
    """

    degrees: NDArray[np.float64]
    observed: NDArray[np.float64]
    model: NDArray[np.float64]


def angle_plot(shading: Shading, vertex: int) -> AnglePlot | None:
    """Compare a voxel's observations with the model.

    Args:
        shading: of the scan, which has observations and a light.
        vertex: its voxel's observations are taken.

    Returns:
        The plot; None where there is nothing to compare.
    """
    scan = shading.scan
    if scan.light is None or not scan.has_observations:
        return None
    surface, voxel = scan.found.surface, int(scan.voxel_of[vertex])
    rows = slice(int(surface.offsets[voxel]), int(surface.offsets[voxel + 1]))
    eyes = surface.view_centres[surface.view_indices[rows]]
    if not len(eyes) or scan.material_at(vertex) is None:
        return None
    light = shading.light(Light.ESTIMATED)
    observed = srgb.LINEAR[surface.colours[rows]] @ LUMINANCE
    model = shading.towards(light, vertex, eyes) @ LUMINANCE
    views = eyes - surface.positions[voxel]
    views /= np.linalg.norm(views, axis=1, keepdims=True)
    cosine = views @ shading.mirror_direction(light, vertex)
    degrees = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    order = np.argsort(degrees, kind="stable")
    return AnglePlot(degrees[order], observed[order], np.minimum(model, 1.0)[order])
