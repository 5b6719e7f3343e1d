# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One camera's calibration, checked again only when its message changes."""

from __future__ import annotations

from reflest_core.capture.camera_info import CalibratedCamera, check_camera_info
from reflest_core.capture.images.rectify import Rectifier
from reflest_core.capture.messages import CameraInfoMessage
from reflest_core.capture.settings import CaptureSettings


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
