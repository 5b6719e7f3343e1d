# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The faults of one camera on its way round one object, the same for sparse scenes and images."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.synbrdf.realism.colour_drift import draw_view_gains
from reflest_core.synbrdf.realism.depth_sensor import DepthSensor
from reflest_core.synbrdf.realism.jpeg import compressed, draw_quality
from reflest_core.synbrdf.realism.pose_jitter import jittered
from reflest_core.synbrdf.realism.sensor_noise import SensorNoise
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.scenes.exposure import expose


@dataclass(frozen=True)
class CameraFaults:
    """The faults of a camera over W views.

    Attributes:
        gains: (W, 3) factors on the exposure of red, green and blue.
        noise: Of the sensor.
        jpeg_quality: 1 to 100; 100 for none.
        depth_sensor: Noise and holes of depth.
        poses: (W, 4, 4) ``T_world_camera`` as tracked.
    """

    gains: NDArray[np.float32]
    noise: SensorNoise
    jpeg_quality: int
    depth_sensor: DepthSensor
    poses: NDArray[np.float64]

    def shown(
        self,
        radiance: NDArray[np.float32],
        exposure: float,
        view: int,
        rng: np.random.Generator,
    ) -> NDArray[np.uint8]:
        """8-bit sRGB (H, W, 3) of linear radiance, before compression.

        Args:
            radiance: linear radiance.
            exposure: factor from radiance to the sensor's white.
            view: index of the view.
            rng: random numbers; the same state draws the same.
        """
        signal = radiance * (np.float32(exposure) * self.gains[view])
        return expose(self.noise.applied(signal, rng), 1.0)

    def image(
        self,
        radiance: NDArray[np.float32],
        exposure: float,
        view: int,
        rng: np.random.Generator,
    ) -> NDArray[np.uint8]:
        """8-bit sRGB (H, W, 3) as the camera's driver hands it on.

        Args:
            radiance: linear radiance.
            exposure: factor from radiance to the sensor's white.
            view: index of the view.
            rng: random numbers; the same state draws the same.
        """
        return compressed(self.shown(radiance, exposure, view, rng), self.jpeg_quality)

    def depth(
        self,
        depth: NDArray[np.float32],
        cosines: NDArray[np.float32],
        camera: CameraIntrinsics,
        rng: np.random.Generator,
    ) -> NDArray[np.float32]:
        """Depth (H, W) in metres as measured, 0 where unknown.

        Args:
            depth: (H, W) metres, 0 where unknown.
            cosines: (H, W) between view and normal.
            camera: intrinsics.
            rng: random numbers; the same state draws the same.
        """
        return self.depth_sensor.measured(depth, cosines, camera, rng)


def draw_camera_faults(
    realism: Realism,
    metered: NDArray[np.float64],
    poses: NDArray[np.float64],
    streams: dict[Effect, np.random.Generator],
) -> CameraFaults:
    """Draw the faults of W views.

    Args:
        realism: which faults, and how strong.
        metered: (W,) mean luminance of each view.
        poses: (W, 4, 4) true ``T_world_camera``.
        streams: random numbers of each fault.
    """
    return CameraFaults(
        gains=draw_view_gains(realism, metered, streams),
        noise=SensorNoise.drawn(realism, streams[Effect.SENSOR]),
        jpeg_quality=draw_quality(realism, streams[Effect.JPEG]),
        depth_sensor=DepthSensor.drawn(realism, streams[Effect.DEPTH]),
        poses=jittered(poses, realism, streams[Effect.POSE]),
    )
