# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Takes lens distortion out of colour, depth and mask, keeping the camera's K (OpenCV's models)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera_info import CalibratedCamera, check_camera_info
from reflest_core.capture.messages import CameraInfoMessage
from reflest_core.capture.settings import CaptureSettings


class Rectifier:
    """Look-up maps of one distorted camera."""

    def __init__(self, camera: CalibratedCamera) -> None:
        """Compute the maps.

        Args:
            camera: with its distortion.
        """
        size = (camera.intrinsics.width, camera.intrinsics.height)
        matrix = camera.intrinsics.matrix
        coefficients = np.array(camera.distortion)
        if camera.is_fisheye:
            maps = cv2.fisheye.initUndistortRectifyMap(
                matrix, coefficients, np.eye(3), matrix, size, cv2.CV_32FC1
            )
        else:
            maps = cv2.initUndistortRectifyMap(
                matrix, coefficients, None, matrix, size, cv2.CV_32FC1
            )
        self._columns, self._rows = maps

    def colour(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return (H, W, 3) uint8, bilinear; pixels from outside the image repeat its edge.

        Args:
            rgb: (H, W, 3) uint8, distorted.
        """
        mapped = cv2.remap(
            rgb, self._columns, self._rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )
        return np.asarray(mapped, dtype=np.uint8)

    def depth(self, depth: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (H, W) float32, nearest neighbour (a mean across an edge is no surface).

        Args:
            depth: (H, W) float32, metres, distorted.
        """
        return np.asarray(self._nearest(depth), dtype=np.float32)

    def mask(self, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return (H, W) bool, nearest neighbour; False outside.

        Args:
            mask: (H, W) bool, distorted.
        """
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
    """Remembers the camera of the last ``CameraInfo`` and its rectifying maps.

    Images are taken as rectified where ``capture.rectified`` says so, or by name: their topic has a
    part that begins with ``image_rect`` and their calibration has distortion beside a valid P.
    """

    def __init__(
        self,
        topic: str,
        image_topic: str,
        settings: CaptureSettings,
        on_warning: Callable[[str], None] = lambda _: None,
    ) -> None:
        """Remember nothing yet.

        Args:
            topic: Of the calibration.
            image_topic: Of the images that it describes.
            settings: Of the capture.
            on_warning: Called once where images are taken as rectified by name.
        """
        self._topic = topic
        self._image_topic = image_topic
        self._settings = settings
        self._rectified = replace(settings, rectified=True)
        self._is_rect_topic = any(part.startswith("image_rect") for part in image_topic.split("/"))
        self._on_warning = on_warning
        self._is_said = False
        self._last: tuple[CameraInfoMessage, CalibratedCamera, Rectifier | None] | None = None

    def of(self, info: CameraInfoMessage) -> tuple[CalibratedCamera, Rectifier | None]:
        """Return the camera and what takes its distortion out, None where it has none.

        Args:
            info: as the driver published it.

        Raises:
            FrameRefused: CAMERA_INFO_INVALID.
        """
        if self._last is None or self._last[0] is not info:
            settings = self._rectified if self._is_rectified(info) else self._settings
            camera = check_camera_info(info, self._topic, settings)
            self._last = (info, camera, Rectifier(camera) if camera.distortion else None)
        return self._last[1:]

    def _is_rectified(self, info: CameraInfoMessage) -> bool:
        if self._settings.rectified or not (
            self._settings.rectified_by_name and self._is_rect_topic and any(info.d)
        ):
            return self._settings.rectified
        if len(info.p) != 12 or not (info.p[0] > 0.0 and info.p[5] > 0.0):
            return False
        if not self._is_said:
            self._is_said = True
            self._on_warning(
                f"{self._image_topic} is taken as rectified by its name: P of {self._topic} is "
                "used and its distortion ignored; set capture.rectified to say so, or turn off "
                "capture.rectified_by_name"
            )
        return True
