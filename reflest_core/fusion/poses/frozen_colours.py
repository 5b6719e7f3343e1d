# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Finds colour images that a driver repeats while depth and pose move on.

No camera that moves gives the same bytes several times. A rendering may, where it shows the same
view (depth is then the same too), or one colour alone.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.poses.agreement import DepthSample, motion

REPEATS = 3
"""So often in a row an image must have come again: associating streams of unlike rates may repeat
one, and frames that come twice do."""
TURN, SHIFT = math.radians(5.0), 0.1
"""Rotation, or distance over the median depth, by which the pose must have moved meanwhile."""
COMPARED_ROWS = 8
"""Rows that are compared first: they differ in nearly all consecutive images."""


class FrozenColours:
    """Counts frames whose colour image is an earlier frame's.

    Attributes:
        frames: Such frames since the scan began, where the pose moved and the depth changed.
    """

    def __init__(self) -> None:
        self.frames = 0
        self._first: tuple[Frame, DepthSample] | None = None
        self._repeats = self._counted = 0

    def restart(self) -> None:
        """Compare the next frame with none before it."""
        self._first = None

    def add(self, frame: Frame, sample: DepthSample) -> None:
        """Take the next frame.

        Args:
            frame: Later than the one before.
            sample: Of the frame's depth.
        """
        if self._first is None or not _is_same(self._first[0].rgb, frame.rgb):
            self._first = frame, sample
            self._repeats = self._counted = 0
            return
        self._repeats += 1
        if self._repeats < REPEATS or not _has_moved(self._first[1], sample):
            return
        if not self._is_one_colour and not _is_same(self._first[1].depth, sample.depth):
            self.frames += self._repeats - self._counted
            self._counted = self._repeats

    @property
    def problem(self) -> str:
        """A sentence where a colour image came again and again, or ""."""
        if not self.frames:
            return ""
        return (
            f"the colour image stayed the same to the byte in {self.frames} frames while pose and "
            "depth moved: the colour stream seems frozen; restart the camera's driver and reset "
            "the scan"
        )

    @property
    def _is_one_colour(self) -> bool:
        """Whether the repeated image shows nothing, such as a saturated or covered camera's."""
        if self._first is None:
            return True
        rgb = self._first[0].rgb
        return bool((rgb == rgb[:1, :1]).all())


def _is_same(one: NDArray[np.generic], other: NDArray[np.generic]) -> bool:
    """Whether two images are equal; a few rows decide it nearly always."""
    if one.shape != other.shape:
        return False
    step = max(len(one) // COMPARED_ROWS, 1)
    rows = np.array_equal(one[step // 2 :: step], other[step // 2 :: step])
    return rows and np.array_equal(one, other)


def _has_moved(first: DepthSample, sample: DepthSample) -> bool:
    turn, distance = motion(first.T_camera_world @ sample.pose)
    return turn > TURN or distance > SHIFT * max(first.median_depth, 1e-6)
