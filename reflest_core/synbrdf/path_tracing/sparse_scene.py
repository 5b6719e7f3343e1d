# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sparse rendering: only what the networks take, each surface point's colour from each view.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters
from reflest_core.light import rgbe
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.synbrdf.path_tracing.mitsuba_scene import (
    TABLETOP_DEPTH,
    RadianceTracer,
    first_hits,
    mitsuba_scene,
)
from reflest_core.synbrdf.path_tracing.scene_voxels import (
    SceneVoxels,
    exact_voxels,
    fused_voxels,
)
from reflest_core.synbrdf.path_tracing.sight import camera_rays
from reflest_core.synbrdf.path_tracing.ward_bsdf import ward_bsdf
from reflest_core.synbrdf.realism.camera_faults import draw_camera_faults
from reflest_core.synbrdf.realism.settings import Realism, streams
from reflest_core.synbrdf.realism.view_images import meter
from reflest_core.synbrdf.room.depth_view import room_sight
from reflest_core.synbrdf.room.room_scene import RoomBuilder
from reflest_core.synbrdf.scenes.exposure import auto_exposure, expose
from reflest_core.synbrdf.scenes.metering import mean_colours
from reflest_core.synbrdf.scenes.scene import Scene
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.synbrdf.scenes.seeding import Purpose, generator
from reflest_core.synbrdf.scenes.surface_points import SurfaceKind
from reflest_core.synbrdf.scenes.thumbnails import THUMBNAIL, Thumbnails
from reflest_core.synbrdf.tabletop.face_ward_bsdf import face_ward_bsdf


@dataclass(frozen=True)
class SparseSettings:
    """How scenes are observed.

    Attributes:
        points: Voxels of a scene.
        views: Cameras.
        samples: Paths of an observation.
        thumbnail_samples: Paths of a thumbnail's pixel.
        surface: Where voxels come from.
        realism: Noise of depth and poses that fused voxels suffer; None for none.
    """

    points: int = 400
    views: int = 100
    samples: int = 64
    thumbnail_samples: int = 4
    surface: SurfaceKind = SurfaceKind.EXACT
    realism: Realism | None = None


@dataclass(frozen=True)
class Overview:
    """A scene as Mitsuba holds it, a small image of every view, and what is metered of them.

    Attributes:
        rendered: The Mitsuba scene.
        exposure: Factor from radiance to the sensor's white.
        thumbnails: The images.
        foreground: (W, 3) float32, mean 8-bit colour of each view's object.
        background: (W, 3) float32, of the rest.
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
        self._tabletops: RadianceTracer | None = None

    def render(self, scene: Scene, seed: int) -> SynbrdfScene:
        """Trace every visible pair of point and view; the same seed gives the same scene.

        Args:
            scene: One object, or a tabletop of several materials.
            seed: Of the data set.
        """
        rng, trace_seed = _tracing(scene, seed)
        overview = self._overview(scene, trace_seed)
        centres = scene.poses[:, :3, 3].astype(np.float32)
        voxels = self._voxels(scene, overview, rng, seed)
        view_of = voxels.view_of
        radiance = self._tracer_of(scene).trace(
            overview.rendered, centres[view_of], voxels.directions, trace_seed
        )
        counts = np.bincount(voxels.voxel_of, minlength=len(voxels.positions))
        surface = ObservedSurface(
            positions=voxels.positions,
            normals=voxels.normals,
            offsets=np.concatenate([[0], np.cumsum(counts)]),
            colours=expose(radiance, overview.exposure),
            view_indices=view_of.astype(np.uint16),
            view_centres=centres,
            view_foreground=overview.foreground,
            view_background=overview.background,
        )
        return SynbrdfScene(
            surface=surface,
            materials=scene.painted.at_faces(voxels.faces),
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

    def _voxels(
        self, scene: Scene, overview: Overview, rng: np.random.Generator, seed: int
    ) -> SceneVoxels:
        settings = self.settings
        if settings.surface is SurfaceKind.EXACT:
            return exact_voxels(overview.rendered, scene, settings.points, rng)
        # The faults that the finished scene's colours and poses will have.
        realism = settings.realism or Realism.only([])
        stream = streams(generator(seed, scene.split, scene.index, Purpose.REALISM))
        poses = overview.thumbnails.T_world_camera.astype(np.float64)
        faults = draw_camera_faults(realism, meter(overview.thumbnails), poses, stream)
        noise = generator(seed, scene.split, scene.index, Purpose.FUSE)
        return fused_voxels(
            overview.rendered, scene, settings.points, faults.depth_sensor, faults.poses, noise
        )

    def _tracer_of(self, scene: Scene) -> RadianceTracer:
        """Light between the surfaces of a tabletop needs longer paths than one object's."""
        if scene.painted.is_uniform:
            return self.tracer
        if self._tabletops is None:
            self._tabletops = RadianceTracer(
                self.settings.samples, lanes=1 << 20, depth=TABLETOP_DEPTH
            )
        return self._tabletops

    def overview(self, scene: Scene, seed: int) -> Overview:
        """What :meth:`render` first looks at: the same exposure and thumbnails.

        Args:
            scene: the scene.
            seed: of the random numbers.
        """
        return self._overview(scene, _tracing(scene, seed)[1])

    def _overview(self, scene: Scene, trace_seed: int) -> Overview:
        bsdf = self.bsdf
        if scene.painted.is_uniform:
            bsdf.set_parameters(scene.painted.dominant.ward)
        else:
            bsdf = face_ward_bsdf(scene.painted)
        if scene.room is None:
            rendered = mitsuba_scene(scene.mesh, bsdf, scene.light.radiance)
        else:
            rendered = self.rooms.scene(scene.mesh, bsdf, scene.room, trace_seed + 2)
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
