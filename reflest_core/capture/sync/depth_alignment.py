# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Depth that is not in colour's frame: whether it can be registered to colour, and doing it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera_info import CalibratedCamera
from reflest_core.capture.images.depth_registration import register_depth
from reflest_core.capture.images.rectify import CheckedCamera
from reflest_core.capture.messages import AnyImage, CameraInfoMessage, Match, Role
from reflest_core.capture.pose import matrix_of_parameter
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.settings import CaptureSettings
from reflest_core.capture.sync.transform_buffer import TransformBuffer


class DepthAlignment:
    """Registers depth by both calibrations and the transform between the two cameras."""

    def __init__(
        self, settings: CaptureSettings, topics: dict[Role, str], transforms: TransformBuffer
    ) -> None:
        self._settings = settings
        self._topics = topics
        self._transforms = transforms
        self._T_rgb_depth = (
            matrix_of_parameter("depth_to_rgb", settings.depth_to_rgb)
            if settings.is_depth_to_rgb_set
            else None
        )
        self._camera = CheckedCamera(topics[Role.DEPTH_INFO], settings)

    def is_needed(self, rgb: AnyImage, depth: AnyImage) -> bool:
        """Whether the two name different frames; an empty name is taken for the same."""
        return bool(
            self._settings.check_frame_ids
            and rgb.frame_id
            and depth.frame_id
            and rgb.frame_id != depth.frame_id
        )

    def is_settled(self, rgb: AnyImage, depth: AnyImage, info: CameraInfoMessage | None) -> bool:
        """Whether no later message can change what becomes of the depth image."""
        if not self.is_needed(rgb, depth):
            return True
        return info is not None and (
            self._T_rgb_depth is not None
            or self._transforms.has_reached(rgb.frame_id, depth.frame_id, depth.stamp_ns)
        )

    def register(
        self,
        pixels: NDArray[np.float32],
        match: Match,
        colour_camera: CalibratedCamera,
    ) -> NDArray[np.float32]:
        """Return the depth image's ``pixels`` (h, w) registered to the undistorted colour camera.

        Raises:
            FrameRefused: FRAME_MISMATCH without a calibration, TRANSFORM_MISSING,
                CAMERA_INFO_INVALID, or SIZE.
        """
        rgb, depth, info = match.rgb, match.depth, match.depth_info
        if info is None:
            raise FrameRefused(
                RefusalCause.FRAME_MISMATCH,
                f"{self._topics[Role.DEPTH]} is in frame {depth.frame_id!r}, colour in "
                f"{rgb.frame_id!r}: use depth aligned to colour, or publish "
                f"{self._topics[Role.DEPTH_INFO]} and the transform (tf or capture.depth_to_rgb) "
                "to have it registered here, or turn off capture.check_frame_ids if it is aligned",
            )
        camera, rectifier = self._camera.of(info)
        expected = (camera.intrinsics.height, camera.intrinsics.width)
        if pixels.shape != expected:
            raise FrameRefused(
                RefusalCause.SIZE,
                f"{self._topics[Role.DEPTH]} has {pixels.shape[1]} x {pixels.shape[0]} pixels, "
                f"{self._topics[Role.DEPTH_INFO]} describes {expected[1]} x {expected[0]}: use the "
                "depth camera's own info",
            )
        transform = self._transform(rgb, depth)
        if rectifier is not None:
            pixels = rectifier.depth(pixels)
        return register_depth(pixels, camera.intrinsics, transform, colour_camera.intrinsics)

    def _transform(self, rgb: AnyImage, depth: AnyImage) -> NDArray[np.float64]:
        if self._T_rgb_depth is not None:
            return self._T_rgb_depth
        try:
            return self._transforms.matrix(rgb.frame_id, depth.frame_id, depth.stamp_ns)
        except FrameRefused as refusal:
            raise FrameRefused(
                refusal.cause,
                f"{self._topics[Role.DEPTH]} cannot be registered to colour: {refusal}; or set "
                "capture.depth_to_rgb",
            ) from refusal
