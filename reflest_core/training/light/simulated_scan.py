# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A SynBRDF scene as a scan would see it: some views, some voxels, lightnet's features of them."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.models.lightnet import VOXELS
from reflest_core.models.lightnet.features import LightFeatures, light_features
from reflest_core.surface.voxel_choice import choose_voxels
from reflest_core.synbrdf.realism.degrade import degrade
from reflest_core.synbrdf.realism.settings import Realism
from reflest_core.synbrdf.relit.scene_light import backgrounds, room_light
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.scanned_scene import scanned

FEWEST_VOXELS, FEWEST_VIEWS = 3, 5
WITHOUT_BACKGROUND = 0.04
"""Share of training's scans in which the object fills every frame."""
LIGHT_VIEWS = 0.4
"""Share of training's scans in which views from below show the light alone."""
KNOWN_ROOMS = 0.15
"""Share of training's scans in which the room's light was known before."""
HIGHEST = 45.0
"""Degrees of elevation, the highest from which on alone views may show the object."""


@dataclass(frozen=True)
class ScanDraw:
    """How a scan of a scene is drawn.

    Attributes:
        views: How many views.
        exposure: Factor to the scene's own exposure.
        realism: Faults of a real capture; None for none.
        sees_light: False where no frame shows any background.
        above: Degrees of elevation; views from below it are as if the camera had been turned away
            from the object and showed the light alone. None: all show the object.
        knows_room: The light that any view shows is known in high dynamic range, as from a
            panorama.
    """

    views: int
    exposure: float = 1.0
    realism: Realism | None = None
    sees_light: bool = True
    above: float | None = None
    knows_room: bool = False


def training_draw(rng: np.random.Generator) -> ScanDraw:
    """Draw 5 to 100 views, an exposure that is a little off, and faults half of the time.

    Args:
        rng: Of random numbers.
    """
    few = rng.uniform() < 0.5
    views = int(np.exp(rng.uniform(np.log(5), np.log(101)))) if few else int(rng.integers(20, 101))
    exposure = float(np.exp(rng.normal(0.0, 0.25)))
    realism = Realism() if rng.uniform() < 0.5 else None
    sees_light = bool(rng.uniform() >= WITHOUT_BACKGROUND)
    above = float(rng.uniform(0.0, HIGHEST)) if rng.uniform() < LIGHT_VIEWS else None
    knows_room = bool(rng.uniform() < KNOWN_ROOMS)
    return ScanDraw(views, exposure, realism, sees_light, above, knows_room)


def simulated_scan(
    scene: SynbrdfScene,
    draw: ScanDraw,
    rng: np.random.Generator,
    without: tuple[str, ...] = (),
) -> LightFeatures | None:
    """Compute lightnet's features of a scan of the scene.

    Args:
        scene: The scene.
        draw: How it is scanned.
        rng: Of random numbers.
        without: See :func:`~reflest_core.models.lightnet.features.light_features`.

    Returns:
        The features; None where the scan shows too little of the surface.
    """
    scene = _exposed(scene, draw.exposure)
    room = room_light(scene) if draw.knows_room else None
    if draw.realism is not None:
        scene = degrade(scene, draw.realism, rng)
    count = len(scene.surface.view_centres)
    views = np.sort(rng.permutation(count)[: min(draw.views, count)])
    views, aside = _parted(scene, views, draw.above)
    surface = scanned(scene, views, draw.realism is None, backgrounds(scene, aside))
    if not draw.sees_light:
        surface = dataclasses.replace(surface, light=None)
    elif room is not None and surface.light is not None:
        surface = dataclasses.replace(surface, light=room.joined(surface.light).light)
    voxels = choose_voxels(surface, VOXELS)
    if len(voxels) < FEWEST_VOXELS:
        return None
    return light_features(surface, voxels, without=without)


def _parted(
    scene: SynbrdfScene, views: NDArray[np.int64], above: float | None
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Split ``views`` into those that show the object and those that show the light alone."""
    if above is None:
        return views, views[:0]
    from_object = scene.surface.view_centres[views] - scene.surface.positions.mean(axis=0)
    sines = from_object[:, 2] / np.linalg.norm(from_object, axis=1)
    shows = sines > np.sin(np.radians(above))
    if shows.sum() < FEWEST_VIEWS:
        return views, views[:0]
    return views[shows], views[~shows]


def _exposed(scene: SynbrdfScene, factor: float) -> SynbrdfScene:
    if factor == 1.0:
        return scene
    exposure = scene.exposure * factor
    colours: NDArray[np.uint8] = expose(scene.radiance.astype(np.float32), exposure)
    surface = dataclasses.replace(scene.surface, colours=colours)
    return dataclasses.replace(scene, surface=surface, exposure=exposure)
