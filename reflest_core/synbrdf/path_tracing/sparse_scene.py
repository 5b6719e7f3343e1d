# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sparse rendering: only what the networks eat, each surface point's colour from each view.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters
from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.light import rgbe
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.synbrdf.path_tracing.mitsuba_scene import (
    RadianceTracer,
    first_hits,
    mitsuba_scene,
)
from reflest_core.synbrdf.path_tracing.ward_bsdf import ward_bsdf
from reflest_core.synbrdf.room.depth_view import room_sight
from reflest_core.synbrdf.room.room_scene import RoomBuilder
from reflest_core.synbrdf.scenes.exposure import auto_exposure, expose
from reflest_core.synbrdf.scenes.metering import mean_colours
from reflest_core.synbrdf.scenes.scene import Scene
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.synbrdf.scenes.seeding import Purpose, generator
from reflest_core.synbrdf.scenes.surface_points import draw_surface_points
from reflest_core.synbrdf.scenes.thumbnails import THUMBNAIL, Thumbnails

MAX_GRAZING_COSINE = 0.25
"""A view further from the normal (75.5 degrees) does not see a point, as in fusion."""
VISIBLE_TOLERANCE = 2e-3
"""Metres between a point and the first surface along its ray within which it is seen."""


@dataclass(frozen=True)
class SparseSettings:
    """``points`` on the surface, ``views`` cameras, ``samples`` a ray, and a thumbnail's pixel."""

    points: int = 400
    views: int = 100
    samples: int = 64
    thumbnail_samples: int = 4


@dataclass(frozen=True)
class Overview:
    """A scene as Mitsuba holds it, a small image of every view, and what is metered of them.

    ``foreground``, ``background``: (W, 3) float32, F and B. ``exposure``: see ``SynbrdfScene``.
    """

    rendered: Any
    exposure: float
    thumbnails: Thumbnails
    foreground: NDArray[np.float32]
    background: NDArray[np.float32]


class SparseRenderer:
    """Renders scenes one after another with one set of kernels."""

    def __init__(self, settings: SparseSettings) -> None:
        """Prepare the kernels.

        Args:
            settings: points, views and samples of a scene.
        """
        self.settings = settings
        self.tracer = RadianceTracer(settings.samples, lanes=1 << 20)
        self.thumbnails = RadianceTracer(settings.thumbnail_samples, lanes=3 << 18, depth=3)
        self.rooms = RoomBuilder()
        self.bsdf = ward_bsdf(WardParameters((0.5, 0.5, 0.5), 0.1, 0.1))

    def render(self, scene: Scene, seed: int) -> SynbrdfScene:
        """Trace every visible pair of point and view; the same seed gives the same scene.

        Args:
            scene: the scene.
            seed: of the random numbers.
        """
        rng, trace_seed = _tracing(scene, seed)
        overview = self._overview(scene, trace_seed)
        positions, normals, _ = draw_surface_points(scene.mesh, self.settings.points, rng)
        centres = scene.poses[:, :3, 3].astype(np.float32)
        point_of, view_of = visible_pairs(overview.rendered, positions, normals, centres)
        directions = _unit(positions[point_of] - centres[view_of])
        radiance = self.tracer.trace(overview.rendered, centres[view_of], directions, trace_seed)
        counts = np.bincount(point_of, minlength=len(positions))
        surface = ObservedSurface(
            positions=positions,
            normals=normals,
            offsets=np.concatenate([[0], np.cumsum(counts)]),
            colours=expose(radiance, overview.exposure),
            view_indices=view_of.astype(np.uint16),
            view_centres=centres,
            view_foreground=overview.foreground,
            view_background=overview.background,
        )
        return SynbrdfScene(
            surface=surface,
            truth=scene.material,
            split=scene.split.value,
            index=scene.index,
            environment=scene.light.name,
            environment_rotation=scene.light.rotation,
            shape=scene.shape,
            view_pattern=scene.view_pattern,
            exposure=overview.exposure,
            radiance=radiance.astype(np.float16),
            thumbnails=overview.thumbnails,
        )

    def overview(self, scene: Scene, seed: int) -> Overview:
        """What :meth:`render` first looks at: the same exposure and thumbnails.

        Args:
            scene: the scene.
            seed: of the random numbers.
        """
        return self._overview(scene, _tracing(scene, seed)[1])

    def _overview(self, scene: Scene, trace_seed: int) -> Overview:
        self.bsdf.set_parameters(scene.material)
        if scene.room is None:
            rendered = mitsuba_scene(scene.mesh, self.bsdf, scene.light.radiance)
        else:
            rendered = self.rooms.scene(scene.mesh, self.bsdf, scene.room, trace_seed + 2)
        origins, directions = camera_rays(THUMBNAIL, scene.poses)
        depth, hits = None, np.isfinite(first_hits(rendered, origins, directions))
        if scene.room is not None:
            forward = np.repeat(scene.poses[:, :3, 2], THUMBNAIL.height * THUMBNAIL.width, axis=0)
            sight = room_sight(rendered, scene.room, origins, directions, forward)
            depth, hits = sight.millimetres, sight.is_object
        traced = self.thumbnails.trace(rendered, origins, directions, trace_seed + 1)
        images = traced.reshape(len(scene.poses), -1, 3)
        is_object = hits.reshape(len(scene.poses), -1)
        exposure = auto_exposure(images)
        foreground, background = mean_colours(expose(images, exposure), is_object)
        shape = (len(scene.poses), THUMBNAIL.height, THUMBNAIL.width)
        thumbnails = Thumbnails(
            rgbe=rgbe.encode(images.reshape(*shape, 3)),
            is_object=is_object.reshape(shape),
            T_world_camera=scene.poses.astype(np.float32),
            depth=None if depth is None else depth.reshape(shape),
        )
        return Overview(rendered, exposure, thumbnails, foreground, background)


def _tracing(scene: Scene, seed: int) -> tuple[np.random.Generator, int]:
    """The stream that surface points come from, and the seed of light paths drawn before them."""
    rng = generator(seed, scene.split, scene.index, Purpose.TRACE)
    return rng, int(rng.integers(2**31))


def camera_rays(
    camera: CameraIntrinsics, poses: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Origins and unit directions (W * H * width, 3) through the pixel centres of every pose.

    Args:
        camera: intrinsics.
        poses: (V, 4, 4) ``T_world_camera``.
    """
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    local = np.stack(
        [(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones(u.shape)], axis=-1
    ).reshape(-1, 3)
    directions = np.einsum("wij,pj->wpi", poses[:, :3, :3], local)
    origins = np.broadcast_to(poses[:, None, :3, 3], directions.shape)
    return (
        origins.reshape(-1, 3).astype(np.float32),
        _unit(directions.reshape(-1, 3).astype(np.float32)),
    )


def visible_pairs(
    rendered: Any,
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    centres: NDArray[np.float32],
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Indices of points and views that see each other, ordered by point, then view.

    Args:
        rendered: the Mitsuba scene.
        positions: (N, 3) metres.
        normals: (N, 3) unit.
        centres: (V, 3) camera centres, metres.
    """
    towards = centres[None] - positions[:, None]
    cosines = np.einsum("pwk,pk->pw", _unit(towards), normals)
    point_of, view_of = np.nonzero(cosines > MAX_GRAZING_COSINE)
    separation = positions[point_of] - centres[view_of]
    distance = np.linalg.norm(separation, axis=1)
    hit = first_hits(rendered, centres[view_of], _unit(separation))
    seen = np.abs(hit - distance) < VISIBLE_TOLERANCE
    return point_of[seen], view_of[seen]


def _unit(vectors: NDArray[np.float32]) -> NDArray[np.float32]:
    unit: NDArray[np.float32] = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return unit
