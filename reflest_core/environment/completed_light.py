# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light where it was not observed: as bright as the object's colours imply, and smooth."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import LUMINANCE_WEIGHTS
from reflest_core.inference.material import explain
from reflest_core.light.completion import RADIANCE, complete, halved_to
from reflest_core.light.light_map import ObservedLight
from reflest_core.light.octahedral import octahedral_directions, octahedral_solid_angles
from reflest_core.surface.observed_surface import ObservedSurface

LEAST_VOXELS = 50
"""The colours of fewer voxels say nothing about the light."""
COARSE, FINE = 24, 48
"""Edges of the maps that brightness is averaged from, and given at."""
SHARPNESS = 8
"""Exponent of the cosine that weighs the average: half its height 24 degrees away."""


def completed_light(surface: ObservedSurface) -> NDArray[np.float32]:
    """Complete the light around a surface.

    What was seen stays, but clipped parts take what the surface's colours ask for beyond white.
    Elsewhere colours come from the light around (:func:`.complete`), brightness from the surface's
    shading and reflections (:func:`.explain`): the patches, 25 degrees each, are right in how much
    light they send, but not in their edges and hues.

    Args:
        surface: What was observed, with its light.

    Returns:
        (N, N, 5) octahedral, world frame: linear radiance (3), share seen, share seen clipped.
    """
    light = surface.light
    assert light is not None
    if surface.voxel_count < LEAST_VOXELS:
        return _with_clipped(complete(light).levels[0], light)
    found = explain(surface, light)
    smooth, explained = found.filled.levels[0], found.light.levels[0]
    is_unseen = light.coverage == 0.0
    brightness = _averaged(explained[..., RADIANCE] @ LUMINANCE_WEIGHTS, is_unseen)
    scale = brightness / np.maximum(smooth[..., RADIANCE] @ LUMINANCE_WEIGHTS, 1e-6)
    completed = explained.copy()
    completed[is_unseen, :3] = smooth[is_unseen, :3] * scale[is_unseen, None]
    return _with_clipped(completed, light)


def _with_clipped(completed: NDArray[np.float32], light: ObservedLight) -> NDArray[np.float32]:
    """The last of the five numbers is of any channel, for so much is known as a bound alone."""
    share = light.any_clipped * light.coverage
    return np.concatenate([completed[..., :4], share[..., None]], axis=-1)


def _averaged(values: NDArray[np.float32], is_counted: NDArray[np.bool_]) -> NDArray[np.float32]:
    """(N, N): means of ``values`` (N, N) within about 24 degrees, where ``is_counted``."""
    pair = halved_to(np.stack([values * is_counted, is_counted.astype(np.float32)], -1), COARSE)
    total, weight = (_kernel() @ pair.reshape(-1, 2)).T
    mean = (total / np.maximum(weight, 1e-6)).reshape(FINE, FINE)
    return np.asarray(cv2.resize(mean, values.shape, interpolation=cv2.INTER_LINEAR), np.float32)


@cache
def _kernel() -> NDArray[np.float32]:
    """(FINE^2, COARSE^2): what each coarse texel counts for in each fine one."""
    fine, coarse = (octahedral_directions(size).reshape(-1, 3) for size in (FINE, COARSE))
    cosine = np.maximum(fine @ coarse.T, 0.0)
    return np.asarray(cosine**SHARPNESS * octahedral_solid_angles(COARSE).reshape(-1), np.float32)
