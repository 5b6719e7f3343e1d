# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Takes lens distortion out of colour, depth and mask, keeping the camera's K."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera_info import CalibratedCamera


class Rectifier:
    """Look-up maps of one distorted camera (plumb_bob and rational_polynomial are OpenCV's)."""

    def __init__(self, camera: CalibratedCamera) -> None:
        size = (camera.intrinsics.width, camera.intrinsics.height)
        matrix = camera.intrinsics.matrix
        self._columns, self._rows = cv2.initUndistortRectifyMap(
            matrix, np.array(camera.distortion), None, matrix, size, cv2.CV_32FC1
        )

    def colour(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return (H, W, 3) uint8, bilinear; pixels from outside the image repeat its edge."""
        mapped = cv2.remap(
            rgb, self._columns, self._rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )
        return np.asarray(mapped, dtype=np.uint8)

    def depth(self, depth: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (H, W) float32, nearest neighbour (a mean across an edge is no surface)."""
        return np.asarray(self._nearest(depth), dtype=np.float32)

    def mask(self, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return (H, W) bool, nearest neighbour; False outside."""
        return np.asarray(self._nearest(mask.astype(np.uint8)), dtype=np.bool_)

    def _nearest(self, image: NDArray[np.uint8] | NDArray[np.float32]) -> NDArray[np.generic]:
        return cv2.remap(
            image,
            self._columns,
            self._rows,
            cv2.INTER_NEAREST,
            borderMode=cv2.BORDER_CONSTANT,
            borderValue=0,
        )
