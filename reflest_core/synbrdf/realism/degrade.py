# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A sparse scene as a real capture would have given it."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.synbrdf.realism.camera_faults import CameraFaults, draw_camera_faults
from reflest_core.synbrdf.realism.depth_holes import hole_probability
from reflest_core.synbrdf.realism.fused_surface import fused
from reflest_core.synbrdf.realism.jpeg import compression_error
from reflest_core.synbrdf.realism.settings import LOSSLESS, Effect, Realism, streams
from reflest_core.synbrdf.realism.view_images import meter, with_gains
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene

COLOUR_EFFECTS = (Effect.EXPOSURE, Effect.WHITE_BALANCE, Effect.SENSOR, Effect.JPEG)


def degrade(scene: SynbrdfScene, realism: Realism, rng: np.random.Generator) -> SynbrdfScene:
    """Give a scene the faults of a real capture; equal generator states give equal scenes.

    Colours, F, B, thumbnails and ``radiance`` follow the drift of exposure and white balance;
    colours alone have noise and artefacts (F and B average them away). Poses and view centres are
    jittered, normals and positions are as fusion leaves them, and observations fall in holes of
    the depth image. The truth and ``exposure`` stay.

    Args:
        scene: the scene, not degraded yet.
        realism: which faults, and how strong.
        rng: random numbers; the same state draws the same.
    """
    stream = streams(rng)
    poses = scene.thumbnails.T_world_camera.astype(np.float64)
    faults = draw_camera_faults(realism, meter(scene.thumbnails), poses, stream)
    if realism.is_on(Effect.DEPTH):
        scene = _without_holes(scene, faults, stream[Effect.DEPTH])
    if any(realism.is_on(effect) for effect in COLOUR_EFFECTS):
        scene = _with_colours(scene, faults, stream)
    if realism.is_on(Effect.POSE):
        scene = _with_poses(scene, faults.poses.astype(np.float32))
    if realism.is_on(Effect.NORMALS):
        surface = scene.surface
        positions, normals = fused(
            surface.positions, surface.normals, realism, stream[Effect.NORMALS]
        )
        surface = dataclasses.replace(surface, positions=positions, normals=normals)
        scene = dataclasses.replace(scene, surface=surface)
    return scene


def _without_holes(
    scene: SynbrdfScene, faults: CameraFaults, rng: np.random.Generator
) -> SynbrdfScene:
    surface = scene.surface
    point_of = np.repeat(np.arange(surface.voxel_count), surface.observation_counts)
    cosines = np.einsum("ij,ij->i", surface.view_directions(), surface.normals[point_of])
    chance = faults.depth_sensor.holes * hole_probability(cosines)
    lost = rng.random(len(cosines), np.float32) < chance
    return dataclasses.replace(scene, surface=_keep(surface, ~lost), radiance=scene.radiance[~lost])


def _keep(surface: ObservedSurface, kept: NDArray[np.bool_]) -> ObservedSurface:
    running = np.concatenate([[0], np.cumsum(kept)])
    return dataclasses.replace(
        surface,
        offsets=running[surface.offsets],
        colours=surface.colours[kept],
        view_indices=surface.view_indices[kept],
    )


def _with_colours(
    scene: SynbrdfScene, faults: CameraFaults, stream: dict[Effect, np.random.Generator]
) -> SynbrdfScene:
    surface, thumbnails = scene.surface, scene.thumbnails
    images = with_gains(thumbnails, scene.exposure, faults.gains)
    radiance = scene.radiance.astype(np.float32) * faults.gains[surface.view_indices]
    signal = faults.noise.applied(radiance * np.float32(scene.exposure), stream[Effect.SENSOR])
    colours = expose(signal, 1.0)
    if faults.jpeg_quality < LOSSLESS:
        error = compression_error(len(colours), faults.jpeg_quality, stream[Effect.JPEG])
        colours = np.clip(np.rint(colours + error), 0, 255).astype(np.uint8)
    return dataclasses.replace(
        scene,
        surface=dataclasses.replace(
            surface,
            colours=colours,
            view_foreground=images.foreground,
            view_background=images.background,
        ),
        radiance=radiance.astype(np.float16),
        thumbnails=dataclasses.replace(thumbnails, rgbe=images.rgbe),
    )


def _with_poses(scene: SynbrdfScene, poses: NDArray[np.float32]) -> SynbrdfScene:
    surface = dataclasses.replace(scene.surface, view_centres=poses[:, :3, 3].copy())
    thumbnails = dataclasses.replace(scene.thumbnails, T_world_camera=poses)
    return dataclasses.replace(scene, surface=surface, thumbnails=thumbnails)
