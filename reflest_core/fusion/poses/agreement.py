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

SAMPLES = 1500
"""Pixels of a frame that are compared at most, about, and a third at least: shares are then known
to 0.02."""
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
        pinhole: fx, fy, cx, cy, pixels.
        rays: (N, 3) x and y at unit depth, and depth, metres, of the sampled pixels.
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
        self.pinhole = np.array([camera.fx, camera.fy, camera.cx, camera.cy])
        valid = COUNTED**2 * np.count_nonzero(self.depth[::COUNTED, ::COUNTED])
        self.rays = _sampled(self.depth, *_strides(valid / SAMPLES), self.pinhole)

    @property
    def size(self) -> int:
        """Number of pixels in the sample."""
        return len(self.rays)

    @cached_property
    def T_camera_world(self) -> NDArray[np.float64]:
        """The inverse of :attr:`pose`, (4, 4)."""
        return np.asarray(np.linalg.inv(self.pose), np.float64)

    @cached_property
    def median_depth(self) -> float:
        """Median depth of the sample, metres; 0 without any."""
        depth, middle = self.rays[:, 2], len(self.rays) // 2
        return float(np.partition(depth, middle)[middle]) if len(depth) else 0.0

    def meets(
        self,
        earlier: DepthSample,
        T_earlier_self: NDArray[np.float64],
        is_ray: bool = False,
        most: int = 4 * SAMPLES,
        focal: float = 1.0,
    ) -> Agreement:
        """Compare this frame's sample with an earlier frame's depth map.

        Args:
            earlier: The frame to land on.
            T_earlier_self: (4, 4) this camera's optical frame in the earlier one's.
            is_ray: Read both depth maps as distances along the pixels' rays.
            most: Compare so many samples at most, about, taken evenly.
            focal: Factor on the focal lengths of both frames.

        Returns:
            The agreement; not known where the two frames share too little.
        """
        transform = kernel_array(T_earlier_self, np.float64)
        agreeing, cost, count = _compared(
            self.rays,
            max(len(self.rays) // most, 1),
            transform,
            earlier.depth,
            earlier.pinhole,
            is_ray,
            focal,
        )
        return Agreement(agreeing / max(count, 1), cost / max(count, 1), count)


def motion(relative: NDArray[np.float64]) -> tuple[float, float]:
    """Measure the motion between two frames.

    Args:
        relative: (4, 4) one camera's pose in the other's frame.

    Returns:
        The angle, radians, and the distance, metres.
    """
    rotation, translation = relative[:3, :3].tolist(), relative[:3, 3].tolist()
    cosine = (rotation[0][0] + rotation[1][1] + rotation[2][2] - 1.0) / 2.0
    return math.acos(min(max(cosine, -1.0), 1.0)), math.hypot(*translation)


def _strides(pixels_a_sample: float) -> tuple[int, int]:
    """Choose strides of rows and columns whose product is at least so much.

    Both are odd, so that depth which is valid in every second row or column alone is met as well.
    """
    of_columns = max(2 * round((math.sqrt(pixels_a_sample) - 1.0) / 2.0) + 1, 1)
    of_rows = max(2 * math.ceil((pixels_a_sample / of_columns - 1.0) / 2.0) + 1, 1)
    return of_rows, of_columns


@compiled
def depth_tolerance(depth: float) -> float:
    """Return the distance along the optical axis within which depths agree.

    Args:
        depth: Metres; 0 where unknown.

    Returns:
        Metres.
    """
    growth = depth * math.sqrt(depth) if depth > 1.0 else 1.0  # to the power GROWTH, but faster
    return float(min(TOLERANCE * growth, RELATIVE_TOLERANCE * depth))


@compiled
def _sampled(
    depth: NDArray[np.float32], of_rows: int, of_columns: int, pinhole: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return x and y at unit depth, and depth, of the valid pixels among the sampled: (N, 3)."""
    fx, fy, cx, cy = pinhole
    height, width = depth.shape
    rays = np.empty(((height // of_rows + 1) * (width // of_columns + 1), 3))
    valid = np.empty(width // of_columns + 1, np.int64)
    count = 0
    for row in range(of_rows // 2, height, of_rows):
        found = 0
        for column in range(of_columns // 2, width, of_columns):  # without a branch to mispredict
            valid[found] = column
            found += (depth[row, column] > 0.0) & (depth[row, column] < math.inf)
        for column in valid[:found]:
            rays[count, 0] = (column - cx) / fx
            rays[count, 1] = (row - cy) / fy
            rays[count, 2] = depth[row, column]
            count += 1
    return rays[:count].copy()


@compiled
def _compared(
    rays: NDArray[np.float64],
    stride: int,
    transform: NDArray[np.float64],
    depth: NDArray[np.float32],
    pinhole: NDArray[np.float64],
    is_ray: bool,
    focal: float,
) -> tuple[int, float, int]:
    """Return how many samples agree, their summed cost, and how many are in sight of both."""
    agreeing, cost, count = 0, 0.0, 0
    fx, fy, cx, cy = pinhole
    fx *= focal
    fy *= focal
    height, width = depth.shape
    for index in range(0, len(rays), stride):
        x, y, here = rays[index]
        x /= focal
        y /= focal
        if is_ray:
            here /= math.sqrt(1.0 + x * x + y * y)
        away = _row(transform[2], x, y, here)
        if not away > 0.0:
            continue
        column = fx * _row(transform[0], x, y, here) / away + cx
        row = fy * _row(transform[1], x, y, here) / away + cy
        if not (-0.5 < column < width - 0.5 and -0.5 < row < height - 0.5):
            continue
        nearest_column, nearest_row = int(column + 0.5), int(row + 0.5)
        at_column, at_row = 0, 0
        there = np.float64(0.0)
        for step in range(4):  # into a gap: the next pixel to the right or below
            at_column = min(nearest_column + step % 2, width - 1)
            at_row = min(nearest_row + step // 2, height - 1)
            there = np.float64(depth[at_row, at_column])
            if 0.0 < there < math.inf:
                break
        if not 0.0 < there < math.inf:
            continue
        if is_ray:
            there /= math.sqrt(1.0 + ((at_column - cx) / fx) ** 2 + ((at_row - cy) / fy) ** 2)
        distance = abs(away - there) / depth_tolerance(there)
        agreeing += 1 if distance <= 1.0 else 0
        cost += min(distance, 1.0)
        count += 1
    return agreeing, cost, count


@compiled
def _row(transform: NDArray[np.float64], x: float, y: float, z: float) -> float:
    """One coordinate of the point at depth ``z`` on the ray (x, y, 1), transformed."""
    return float(transform[0] * x * z + transform[1] * y * z + transform[2] * z + transform[3])
