# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Takes lens distortion out of colour, depth and mask, keeping the camera's K."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera_info import CalibratedCamera, check_camera_info
from reflest_core.capture.messages import CameraInfoMessage
from reflest_core.capture.settings import CaptureSettings


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


class CheckedCamera:
    """Remembers the camera of the last ``CameraInfo`` and its rectifying maps."""

    def __init__(self, topic: str, settings: CaptureSettings) -> None:
        self._topic = topic
        self._settings = settings
        self._last: tuple[CameraInfoMessage, CalibratedCamera, Rectifier | None] | None = None

    def of(self, info: CameraInfoMessage) -> tuple[CalibratedCamera, Rectifier | None]:
        """Return the camera and what takes its distortion out, None where it has none.

        Raises:
            FrameRefused: CAMERA_INFO_INVALID.
        """
        if self._last is None or self._last[0] is not info:
            camera = check_camera_info(info, self._topic, self._settings)
            self._last = (info, camera, Rectifier(camera) if camera.distortion else None)
        return self._last[1:]
