# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A SynBRDF scene as a live scan from some of its views would have it."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reflest_core.light.exposure_correction import at_one_exposure, means_at_one_exposure
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.selection import keep_views
from reflest_core.synbrdf.relit.scene_light import Background, light_and_gains, scene_light
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene


def scanned(
    scene: SynbrdfScene,
    views: NDArray[np.int64],
    is_exposure_locked: bool = False,
    background_frames: Sequence[Background] = (),
) -> ObservedSurface:
    """Make the surface and the light behind it as a live scan from some views would have them.

    Changes of exposure are found in the background and corrected, as while scanning.

    Args:
        scene: The whole scene.
        views: Indices of the views that show the surface.
        is_exposure_locked: There are no changes of exposure; this spares the search for them.
        background_frames: Frames beside the object that show more of the light.
    """
    surface = keep_views(scene.surface, views)
    if is_exposure_locked:
        return dataclasses.replace(surface, light=scene_light(scene, views, background_frames))
    light, gains = light_and_gains(scene, views, background_frames)
    return dataclasses.replace(
        surface,
        light=light,
        colours=at_one_exposure(surface.colours, gains, surface.view_indices),
        view_foreground=means_at_one_exposure(surface.view_foreground, gains),
        view_background=means_at_one_exposure(surface.view_background, gains),
    )
