# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Depth as a structured-light camera of the first Kinect's kind measures it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.jit import compiled, kernel_array
from reflest_core.synbrdf.realism.depth_holes import hole_probability
from reflest_core.synbrdf.realism.settings import Realism

BASELINE = 0.075
"""Metres from the infrared projector to the camera."""
DISPARITY_STEP = 0.125
"""Pixels at the width of 640 that the disparity is quantised to (Khoshelham & Elberink 2012)."""
SMOOTHNESS = 1.0
"""Pixels, Gaussian: errors of neighbouring pixels are alike, for each matches a window."""
EDGE_STEP, EDGE_LOSS = 0.02, 0.5
"""A pixel is at an edge where depth about it differs by this share; so many of them are lost."""


@dataclass(frozen=True)
class DepthSensor:
    """Multiples of the measured noise and of the chance of holes; 0 measures exactly.

    Axial and lateral noise by Nguyen, Izadi & Lovell, "Modeling Kinect sensor noise for improved
    3D reconstruction and tracking", 3DIMPVT 2012; quantised disparity by Khoshelham & Elberink,
    "Accuracy and resolution of Kinect depth data for indoor mapping applications", Sensors 2012.
    What the projector beside the camera does not reach is not measured.
    """

    noise: float
    holes: float

    @classmethod
    def drawn(cls, realism: Realism, rng: np.random.Generator) -> DepthSensor:
        """A scene's sensor.

        Args:
            realism: which faults, and how strong.
            rng: random numbers; the same state draws the same.
        """
        holes, noise = rng.uniform(size=2)
        return cls(realism.depth_noise * noise, realism.depth_holes * holes)

    def measured(
        self,
        depth: NDArray[np.float32],
        cosines: NDArray[np.float32],
        camera: CameraIntrinsics,
        rng: np.random.Generator,
    ) -> NDArray[np.float32]:
        """Measure a depth image.

        Args:
            depth: (H, W) true depth in metres, 0 where there is none.
            cosines: (H, W) between each pixel's ray and the normal there.
            camera: intrinsics.
            rng: random numbers; the same state draws the same.

        Returns:
            (H, W) metres; 0 where the true depth is 0, and in holes.
        """
        if self.noise == 0.0 and self.holes == 0.0:
            return depth
        angle = np.arccos(np.clip(cosines, 0.05, 1.0)).astype(np.float32)
        noisy = self._with_noise(depth, angle, camera, rng) if self.noise > 0.0 else depth
        lost = self._lost(depth, cosines, camera, rng) if self.holes > 0.0 else False
        return np.where(lost, np.float32(0.0), noisy)

    def _with_noise(
        self,
        depth: NDArray[np.float32],
        angle: NDArray[np.float32],
        camera: CameraIntrinsics,
        rng: np.random.Generator,
    ) -> NDArray[np.float32]:
        grazing = angle / (0.5 * math.pi - angle)
        # Lateral: a pixel's depth is that of a place beside it, so that outlines are ragged.
        scale = camera.width / 640.0
        aside = self.noise * scale * (0.8 + 0.035 * grazing)
        row, column = np.indices(depth.shape)
        across = np.rint(column + aside * _smooth(rng, depth.shape)).astype(np.intp)
        down = np.rint(row + aside * _smooth(rng, depth.shape)).astype(np.intp)
        inside = np.clip(down, 0, camera.height - 1), np.clip(across, 0, camera.width - 1)
        seen = depth[inside]
        z = np.maximum(seen, np.float32(0.1))
        axial = 0.0012 + 0.0019 * (z - 0.4) ** 2 + 0.0001 / np.sqrt(z) * grazing**2
        z = z + self.noise * np.minimum(axial, 0.1 * z) * _smooth(rng, depth.shape)
        step = DISPARITY_STEP * scale
        disparity = np.maximum(np.rint(camera.fx * BASELINE / z / step) * step, step)
        return np.where(seen > 0.0, camera.fx * BASELINE / disparity, 0.0).astype(np.float32)

    def _lost(
        self,
        depth: NDArray[np.float32],
        cosines: NDArray[np.float32],
        camera: CameraIntrinsics,
        rng: np.random.Generator,
    ) -> NDArray[np.bool_]:
        chance = self.holes * hole_probability(cosines)
        square = np.ones((3, 3), np.uint8)
        is_edge = cv2.dilate(depth, square) - cv2.erode(depth, square) > EDGE_STEP * depth
        chance = np.where(is_edge, np.maximum(chance, self.holes * EDGE_LOSS), chance)
        # Holes come in clumps, as the errors do.
        clumped = _smooth(rng, depth.shape) < ndtri(np.minimum(chance, 1.0))
        shadow = _in_shadow(kernel_array(depth, np.float32), camera.fx * BASELINE)
        return np.asarray(clumped | shadow)


def _smooth(rng: np.random.Generator, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Unit normal noise (H, W), smooth over :data:`SMOOTHNESS`."""
    noise = rng.standard_normal(shape, np.float32)
    gain = 2.0 * math.sqrt(math.pi) * SMOOTHNESS
    return np.asarray(cv2.GaussianBlur(noise, (0, 0), SMOOTHNESS) * gain, np.float32)


@compiled
def _in_shadow(depth: NDArray[np.float32], focal_baseline: float) -> NDArray[np.bool_]:
    """(H, W) bool: surfaces hidden from a projector to the left of the camera.

    Seen from there, columns move right by their disparity; whatever does not move past all that
    is left of it lies behind that.
    """
    height, width = depth.shape
    shadow = np.zeros((height, width), np.bool_)
    for v in range(height):
        reached = -np.inf
        for u in range(width):
            if depth[v, u] <= 0.0:
                continue
            column = u + focal_baseline / depth[v, u]
            # A pixel's slack, for a sloping surface moves its columns closer.
            if column < reached - 1.0:
                shadow[v, u] = True
            reached = max(reached, column)
    return shadow
