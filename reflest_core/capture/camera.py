# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Pinhole intrinsics of a rectified camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class CameraIntrinsics:
    """Pixel centres lie at integer coordinates (OpenCV, ROS ``CameraInfo.k``).

    Attributes:
        width: Columns of the image.
        height: Rows of the image.
        fx: Horizontal focal length, pixels.
        fy: Vertical focal length, pixels.
        cx: Column of the principal point.
        cy: Row of the principal point.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    @property
    def matrix(self) -> NDArray[np.float64]:
        """The (3, 3) matrix K: camera coordinates to homogeneous pixels."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])
