# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light that a camera sees behind the object of a scene: what a live scan would gather."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reflest_core.light import rgbe
from reflest_core.light.known_light import KnownLight
from reflest_core.light.light_map import SIZE, LightMap, ObservedLight
from reflest_core.light.octahedral import octahedral_texels
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.synbrdf.scenes.thumbnails import THUMBNAIL, Thumbnails

Background = tuple[NDArray[np.float32], NDArray[np.uint8]]
"""Directions (P, 3) in the world frame, of any length, and 8-bit colours (P, 3) of pixels."""


def scene_light(
    scene: SynbrdfScene, views: NDArray[np.int64], background_frames: Sequence[Background] = ()
) -> ObservedLight:
    """Gather the environment as the background of some views shows it, through 8-bit images.

    As :func:`.background_pixels` does live, background with depth is placed where the middle of the
    surface sees it, and what has none is taken to be infinitely far. The camera's exposure is
    taken to be locked.

    Args:
        scene: the scene.
        views: (N,) indices; the order of the scan.
        background_frames: frames that come after the views and show no object.
    """
    light = LightMap()
    for directions, colours in (*backgrounds(scene, views), *background_frames):
        light.add(directions, colours)
    return light.observed()


def light_and_gains(
    scene: SynbrdfScene, views: NDArray[np.int64], background_frames: Sequence[Background] = ()
) -> tuple[ObservedLight, NDArray[np.float32]]:
    """Gather the same, and infer each view's exposure from its background as the live path does.

    Where parallax blurs the background, the live path infers it from the object's own voxels; this
    does not.

    Args:
        scene: the scene, of W views.
        views: (N,) indices; the order of the scan.
        background_frames: frames that come after the views and show no object.

    Returns:
        The light, and (W,) gains; 1 for views that are not among ``views``.
    """
    gains = np.ones(len(scene.surface.view_centres), np.float32)
    light = LightMap()
    for view, (directions, colours) in zip(views, backgrounds(scene, views), strict=True):
        gains[view] = light.add_frame(directions, colours)
    for directions, colours in background_frames:
        light.add_frame(directions, colours)
    return light.observed(), gains


def room_light(scene: SynbrdfScene) -> KnownLight:
    """The environment as all of the scene's views show it together, in high dynamic range.

    As if somebody had taken a panorama of the room before, of the directions that any view shows.

    Args:
        scene: the scene.
    """
    thumbnails = scene.thumbnails
    directions = background_directions(thumbnails, scene.surface.positions.mean(axis=0))
    is_background = ~thumbnails.is_object
    texels = octahedral_texels(directions[is_background], SIZE)
    radiance = thumbnails.radiance()[is_background] * np.float32(scene.exposure)
    counts = np.bincount(texels, minlength=SIZE * SIZE)
    sums = np.stack(
        [np.bincount(texels, radiance[:, c], minlength=SIZE * SIZE) for c in range(3)], axis=-1
    )
    mean = (sums / np.maximum(counts, 1)[:, None]).astype(np.float32)
    return KnownLight(mean.reshape(SIZE, SIZE, 3), (counts > 0).reshape(SIZE, SIZE))


def backgrounds(scene: SynbrdfScene, views: NDArray[np.int64]) -> list[Background]:
    """Collect what each view shows beside the object.

    Args:
        scene: the scene.
        views: (N,) indices.
    """
    return [
        (directions[is_background], colours[is_background])
        for is_background, directions, colours in zip(*_background(scene, views), strict=True)
    ]


def _background(
    scene: SynbrdfScene, views: NDArray[np.int64]
) -> tuple[NDArray[np.bool_], NDArray[np.float32], NDArray[np.uint8]]:
    """Of the thumbnails' pixels (W, 36, 48): which are background, direction and colour."""
    thumbnails = scene.thumbnails.of_views(views)
    colours = expose(rgbe.decode(thumbnails.rgbe), scene.exposure)
    directions = background_directions(thumbnails, scene.surface.positions.mean(axis=0))
    return ~thumbnails.is_object, directions, colours


def background_directions(
    thumbnails: Thumbnails, object_centre: NDArray[np.floating]
) -> NDArray[np.float32]:
    """Compute the directions from the object's middle to what each pixel shows.

    Args:
        thumbnails: small images of all W views.
        object_centre: (3,) metres.

    Returns:
        (W, 36, 48, 3), of any length.
    """
    poses = thumbnails.T_world_camera[:, None]
    towards = pixel_rays() @ thumbnails.T_world_camera[:, :3, :3].swapaxes(-1, -2)
    towards = towards.reshape(*thumbnails.is_object.shape, 3)
    if thumbnails.depth is None:
        return np.asarray(towards, np.float32)
    depth = (thumbnails.depth / 1000.0)[..., None]
    from_centre = depth * towards + poses[:, :, None, :3, 3] - object_centre
    return np.where(depth > 0.0, from_centre, towards).astype(np.float32)


def pixel_rays() -> NDArray[np.float32]:
    """Directions (36 * 48, 3) through the pixels' centres, row by row, camera frame."""
    u, v = np.meshgrid(np.arange(THUMBNAIL.width), np.arange(THUMBNAIL.height))
    x, y = (u - THUMBNAIL.cx) / THUMBNAIL.fx, (v - THUMBNAIL.cy) / THUMBNAIL.fy
    return np.stack([x, y, np.ones(u.shape)], axis=-1).astype(np.float32).reshape(-1, 3)
