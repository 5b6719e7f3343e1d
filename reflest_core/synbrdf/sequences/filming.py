# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A camera's recording of a scene: exposure, faults and frames. Importing this loads Mitsuba."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import luminance
from reflest_core.synbrdf.path_tracing.full_image import FullImageRenderer
from reflest_core.synbrdf.path_tracing.mitsuba_scene import PATH_DEPTH, RadianceTracer
from reflest_core.synbrdf.path_tracing.sight import camera_rays
from reflest_core.synbrdf.realism.camera_faults import CameraFaults, draw_camera_faults
from reflest_core.synbrdf.realism.settings import Realism, streams
from reflest_core.synbrdf.room.geometry import Room
from reflest_core.synbrdf.scenes.exposure import auto_exposure, expose
from reflest_core.synbrdf.scenes.thumbnails import THUMBNAIL
from reflest_core.synbrdf.scenes.views import depth_camera
from reflest_core.synbrdf.sequences.bag_writer import RecordedFrame

START_NS = 1_750_000_000 * 10**9
"""Stamp of the first frame, the same in every sequence."""
EXPOSED_FRAMES = 16
"""Spread over the sequence; they meter the exposure that all frames share."""
REALISM_STREAM = 0x5EA1
"""Keeps the faults' random numbers apart from the scene's."""


@dataclass(frozen=True)
class Stage:
    """What is filmed.

    Attributes:
        rendered: The scene as Mitsuba holds it.
        environment: Lat-long map (H, 2 H, 3) that the background shows, linear sRGB.
        poses: ``T_world_camera`` (W, 4, 4), optical frames.
        room: What stands about the scene; None under distant light.
    """

    rendered: Any
    environment: NDArray[np.float32]
    poses: NDArray[np.float64]
    room: Room | None = None


@dataclass(frozen=True)
class FilmSettings:
    """How a stage is filmed.

    Attributes:
        seed: Decides light paths and faults.
        width: Pixels.
        height: Pixels.
        samples: Paths of a pixel.
        rate: Frames a second.
        realism: The faults of a real camera; None for a perfect one.
        path_depth: Mitsuba's ``max_depth``.
    """

    seed: int
    width: int
    height: int
    samples: int
    rate: float
    realism: Realism | None
    path_depth: int = PATH_DEPTH


class Film:
    """Frames of a stage, in the order in which they were taken.

    Attributes:
        camera: Intrinsics of the images.
        exposure: Factor from linear radiance to the sensor's [0, 1], shared by all frames.
    """

    def __init__(self, stage: Stage, settings: FilmSettings) -> None:
        """Meter the exposure and draw the camera's faults.

        Args:
            stage: what is filmed.
            settings: size, rate and samples of the film.
        """
        self.camera = depth_camera(settings.width, settings.height)
        self._stage, self._settings = stage, settings
        last = len(stage.poses) - 1
        chosen = np.unique(np.linspace(0, last, EXPOSED_FRAMES).round().astype(int))
        self.exposure = auto_exposure(self._metered(stage.poses[chosen]))
        self._faults = None
        if settings.realism is not None:
            self._faults = self._draw_faults(settings.realism)

    def frames(self) -> Iterator[RecordedFrame]:
        """Render one frame after another."""
        stage, settings = self._stage, self._settings
        renderer = FullImageRenderer(self.camera, settings.samples, settings.path_depth)
        for index, pose in enumerate(stage.poses):
            seed = _seed(settings.seed, index + 1)
            image = renderer.render(stage.rendered, stage.environment, pose, seed, stage.room)
            if self._faults is None:
                rgb, depth, tracked = expose(image.radiance, self.exposure), image.depth, pose
            else:
                rng = np.random.default_rng([REALISM_STREAM, settings.seed, index + 1])
                rgb = self._faults.image(image.radiance, self.exposure, index, rng)
                depth = self._faults.depth(image.depth, image.cosines, self.camera, rng)
                tracked = self._faults.poses[index]
            yield RecordedFrame(
                stamp_ns=START_NS + round(index * 1e9 / settings.rate),
                rgb=rgb,
                depth_mm=np.rint(depth * 1000.0).astype(np.uint16),
                pose=tracked,
            )

    def _metered(self, poses: NDArray[np.float64]) -> NDArray[np.float32]:
        """Radiance (W, P, 3) of a small image from each pose."""
        origins, directions = camera_rays(THUMBNAIL, poses)
        tracer = RadianceTracer(4, lanes=1 << 17)
        seed = _seed(self._settings.seed, 0)
        radiance = tracer.trace(self._stage.rendered, origins, directions, seed)
        return radiance.reshape(len(poses), -1, 3)

    def _draw_faults(self, realism: Realism) -> CameraFaults:
        poses = self._stage.poses
        light = np.maximum(luminance(self._metered(poses).astype(np.float64)), 1e-6)
        brightness = np.exp(np.log(light).mean(axis=1))
        rng = np.random.default_rng([REALISM_STREAM, self._settings.seed])
        return draw_camera_faults(realism, brightness, poses, streams(rng))


def _seed(seed: int, frame: int) -> int:
    return int(np.random.SeedSequence([seed, frame]).generate_state(1)[0] >> 1)
