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
    looks_away: Sequence[Background] = (),
) -> ObservedSurface:
    """What ``views`` show of the surface and of the light behind it; nothing of another view.

    ``looks_away``: frames beside the object that show more of the light.

    Changes of exposure are told from the background and made up for, as while scanning.
    ``is_exposure_locked`` says that there are none, and spares the search, which hardly ever finds
    one then.
    """
    surface = keep_views(scene.surface, views)
    if is_exposure_locked:
        return dataclasses.replace(surface, light=scene_light(scene, views, looks_away))
    light, gains = light_and_gains(scene, views, looks_away)
    return dataclasses.replace(
        surface,
        light=light,
        colours=at_one_exposure(surface.colours, gains, surface.view_indices),
        view_foreground=means_at_one_exposure(surface.view_foreground, gains),
        view_background=means_at_one_exposure(surface.view_background, gains),
    )
