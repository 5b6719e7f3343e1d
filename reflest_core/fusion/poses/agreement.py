# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How well two depth maps meet under the poses that came with them.

A sample of one frame's depth is moved into an earlier frame by the two poses. Where poses, units
and intrinsics are right, it lands on that frame's depth.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.jit import compiled, kernel_array

SAMPLES = 700
"""Pixels of a frame that are compared, about: shares are then known to 0.02."""
COUNTED = 5
"""Every fifth pixel of every fifth row shows how much of the image is valid."""
FEWEST = 15
"""With fewer samples in sight of both frames a pair says nothing."""
TOLERANCE = 0.01
"""Distance along the optical axis within which depths agree, metres at up to one metre away."""
GROWTH = 1.5
"""Beyond one metre the tolerance grows with this power of depth: a sensor's noise does."""
RELATIVE_TOLERANCE = 0.05
"""The tolerance is never more than this share of the depth."""


@dataclass(frozen=True)
class Agreement:
    """How well two depth maps meet.

    Attributes:
        share: Share in [0, 1] of the samples in sight of both frames that agree within tolerance.
        cost: Mean distance of those samples over the tolerance, each at most 1.
        count: Samples in sight of both frames.
    """

    share: float
    cost: float
    count: int

    @property
    def is_known(self) -> bool:
        """Whether there were enough samples to judge by."""
        return self.count >= FEWEST


class DepthSample:
    """One frame's depth map, pose and a regular sample of its valid pixels.

    Attributes:
        depth: (H, W) float32 metres; 0 where unknown or masked away.
        pose: (4, 4) float64, ``T_world_camera``.
    """

    def __init__(self, frame: Frame) -> None:
        """Draw the sample.

        Args:
            frame: Depth in metres with its pose and intrinsics.
        """
        # What is masked away, a hand or a turntable, need not move as the object does.
        depth = frame.depth if frame.mask is None else np.where(frame.mask, frame.depth, 0.0)
        self.depth = kernel_array(depth, np.float32)
        self.pose = np.asarray(frame.T_world_camera, np.float64)
        camera = frame.intrinsics
        self._pinhole = np.array([camera.fx, camera.fy, camera.cx, camera.cy])
        # Odd, so that depth which is valid in every second row or column alone is met as well.
        valid = COUNTED**2 * np.count_nonzero(self.depth[::COUNTED, ::COUNTED])
        stride = max((int(math.sqrt(valid / SAMPLES)) + 1) // 2 * 2 - 1, 1)
        self._rays = _sampled(self.depth, stride, self._pinhole)

    @cached_property
    def median_depth(self) -> float:
        """Median depth of the sample, metres; 0 without any."""
        return float(np.median(self._rays[:, 2])) if len(self._rays) else 0.0

    def meets(
        self, earlier: DepthSample, T_earlier_self: NDArray[np.float64], is_ray: bool = False
    ) -> Agreement:
        """Compare this frame's sample with an earlier frame's depth map.

        Args:
            earlier: The frame to land on.
            T_earlier_self: (4, 4) this camera's optical frame in the earlier one's.
            is_ray: Read both depth maps as distances along the pixels' rays.

        Returns:
            The agreement; not known where the two frames share too little.
        """
        transform = kernel_array(T_earlier_self, np.float64)
        agreeing, cost, count = _compared(
            self._rays, transform, earlier.depth, earlier._pinhole, is_ray
        )
        return Agreement(agreeing / max(count, 1), cost / max(count, 1), count)


@compiled
def _sampled(
    depth: NDArray[np.float32], stride: int, pinhole: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return x and y at unit depth, and depth, of every ``stride``-th valid pixel: (N, 3)."""
    fx, fy, cx, cy = pinhole
    height, width = depth.shape
    rays = np.empty(((height // stride + 1) * (width // stride + 1), 3))
    count = 0
    for row in range(stride // 2, height, stride):
        for column in range(stride // 2, width, stride):
            z = depth[row, column]
            if 0.0 < z < math.inf:
                rays[count, 0] = (column - cx) / fx
                rays[count, 1] = (row - cy) / fy
                rays[count, 2] = z
                count += 1
    return rays[:count].copy()


@compiled
def _compared(
    rays: NDArray[np.float64],
    transform: NDArray[np.float64],
    depth: NDArray[np.float32],
    pinhole: NDArray[np.float64],
    is_ray: bool,
) -> tuple[int, float, int]:
    """Return how many samples agree, their summed cost, and how many are in sight of both."""
    agreeing, cost, count = 0, 0.0, 0
    fx, fy, cx, cy = pinhole
    height, width = depth.shape
    for index in range(len(rays)):
        x, y, here = rays[index]
        if is_ray:
            here /= math.sqrt(1.0 + x * x + y * y)
        away = _row(transform[2], x, y, here)
        if not away > 0.0:
            continue
        column = fx * _row(transform[0], x, y, here) / away + cx
        row = fy * _row(transform[1], x, y, here) / away + cy
        if not (-0.5 < column < width - 0.5 and -0.5 < row < height - 0.5):
            continue
        at_column, at_row = 0, 0
        there = np.float64(0.0)
        for step in range(4):  # into a gap: the next pixel to the right or below
            if not 0.0 < there < math.inf:
                at_column = min(round(column) + step % 2, width - 1)
                at_row = min(round(row) + step // 2, height - 1)
                there = np.float64(depth[at_row, at_column])
        if not 0.0 < there < math.inf:
            continue
        if is_ray:
            there /= math.sqrt(1.0 + ((at_column - cx) / fx) ** 2 + ((at_row - cy) / fy) ** 2)
        tolerance = min(TOLERANCE * max(there, 1.0) ** GROWTH, RELATIVE_TOLERANCE * there)
        distance = abs(away - there) / tolerance
        agreeing += distance <= 1.0
        cost += min(distance, 1.0)
        count += 1
    return agreeing, cost, count


@compiled
def _row(transform: NDArray[np.float64], x: float, y: float, z: float) -> float:
    """One coordinate of the point at depth ``z`` on the ray (x, y, 1), transformed."""
    return float(transform[0] * x * z + transform[1] * y * z + transform[2] * z + transform[3])
