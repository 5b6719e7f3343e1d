# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light that a camera sees behind the object of a scene: what a live scan would gather."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.light_map import LightMap, ObservedLight
from reflest_core.synbrdf.exposure import expose
from reflest_core.synbrdf.scene_file import SynbrdfScene
from reflest_core.synbrdf.thumbnails import THUMBNAIL


def scene_light(scene: SynbrdfScene, views: NDArray[np.int64]) -> ObservedLight:
    """The environment as the background of ``views`` shows it, through 8-bit images."""
    thumbnails = scene.thumbnails.of_views(views)
    images = expose(thumbnails.radiance(), scene.exposure)
    rotations = thumbnails.T_world_camera[:, None, :3, :3]
    directions = _pixel_rays() @ rotations.swapaxes(-1, -2)
    is_background = ~thumbnails.is_object
    light = LightMap()
    light.add(directions[is_background], images[is_background])
    return light.observed()


def _pixel_rays() -> NDArray[np.float32]:
    """Directions (36, 48, 3) through the pixels' centres, camera frame."""
    u, v = np.meshgrid(np.arange(THUMBNAIL.width), np.arange(THUMBNAIL.height))
    x, y = (u - THUMBNAIL.cx) / THUMBNAIL.fx, (v - THUMBNAIL.cy) / THUMBNAIL.fy
    return np.stack([x, y, np.ones(u.shape)], axis=-1).astype(np.float32)
