# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The shading of a surface under the light that it was seen in, or under an assumed one."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.light import seen_light
from reflest_core.inference.material import Explanation, explain
from reflest_core.models.lightnet.shading import Shading, shading
from reflest_core.surface.observed_surface import ObservedSurface


def surface_shading(
    surface: ObservedSurface,
    voxels: NDArray[np.int64],
    found: Explanation | None = None,
    without: tuple[str, ...] = (),
) -> Shading:
    """Shade voxels by the light that the surface was seen in.

    Args:
        surface: a scan, or a material's part of one.
        voxels: (V,) indices into ``surface``.
        found: the surface as a material in the light of its scene; None explains it as a scene of
            one material by ``surface.light``, or by :func:`~.light.assumed_light` if none was seen.
        without: ablations. "completion" leaves the light smoothly filled where it was not seen,
            "visibility" lets the surface hide no light from itself.
    """
    if found is None:
        found = explain(surface, seen_light(surface), "visibility" not in without)
    if "completion" in without:
        found = dataclasses.replace(found, light=found.filled)
    return shading(found, voxels)
