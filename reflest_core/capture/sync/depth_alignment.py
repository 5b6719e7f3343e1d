# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Depth that is not in colour's frame: whether it can be registered to colour, and doing it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera_info import CalibratedCamera
from reflest_core.capture.images.compressed import pixel_size
from reflest_core.capture.images.depth_registration import along_axis, register_depth
from reflest_core.capture.images.rectify import CheckedCamera
from reflest_core.capture.messages import (
    AnyImage,
    CameraInfoMessage,
    Match,
    Role,
    plain_frame,
)
from reflest_core.capture.pose import matrix_of_parameter
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.settings import CaptureSettings
from reflest_core.capture.sync.transform_buffer import TransformBuffer


class DepthAlignment:
    """Registers depth by both calibrations and the transform between the two cameras."""

    def __init__(
        self,
        settings: CaptureSettings,
        topics: dict[Role, str],
        transforms: TransformBuffer,
        on_warning: Callable[[str], None] = lambda _: None,
    ) -> None:
        """Begin without calibrations.

        Args:
            settings: parameters of the group ``capture``.
            topics: names of the streams for sentences.
            transforms: all that came by tf.
            on_warning: called with sentences about the calibrations.
        """
        self._settings = settings
        self._topics = topics
        self._transforms = transforms
        self._T_rgb_depth = (
            matrix_of_parameter("depth_to_rgb", settings.depth_to_rgb)
            if settings.is_depth_to_rgb_set
            else None
        )
        self._camera = CheckedCamera(
            topics[Role.DEPTH_INFO], topics[Role.DEPTH], settings, on_warning
        )

    def is_needed(self, rgb: AnyImage, depth: AnyImage) -> bool:
        """Check whether depth must be registered: it is in another frame, or of another size.

        Args:
            rgb: The colour image.
            depth: The depth image; where either names no frame, the frames are taken for the same.
        """
        if self._is_apart(rgb, depth):
            return True
        sizes = {pixel_size(rgb), pixel_size(depth)}
        return len(sizes) == 2 and None not in sizes

    def is_decided(self, rgb: AnyImage, depth: AnyImage, info: CameraInfoMessage | None) -> bool:
        """Check whether no later message can change what becomes of the depth image.

        Args:
            rgb: The colour image.
            depth: The depth image.
            info: The depth camera's calibration, if any has come.
        """
        if not self.is_needed(rgb, depth):
            return True
        return info is not None and (
            not self._is_apart(rgb, depth)
            or self._T_rgb_depth is not None
            or self._transforms.has_reached(rgb.frame_id, depth.frame_id, depth.stamp_ns)
        )

    def register(
        self,
        pixels: NDArray[np.float32],
        match: Match,
        colour_camera: CalibratedCamera,
    ) -> NDArray[np.float32]:
        """Register depth to the undistorted colour camera by the two calibrations.

        Args:
            pixels: (h, w) the depth image, metres.
            match: Its message and those that belong to it.
            colour_camera: The camera to register to.

        Returns:
            (H, W) metres, of the colour camera's size.

        Raises:
            FrameRefused: FRAME_MISMATCH or SIZE without a calibration, TRANSFORM_MISSING,
                CAMERA_INFO_INVALID.
        """
        info = match.depth_info
        if info is None:
            raise self._without_info(match, pixels, colour_camera)
        camera, rectifier = self._camera.of(info)
        expected = (camera.intrinsics.height, camera.intrinsics.width)
        if pixels.shape != expected:
            raise FrameRefused(
                RefusalCause.SIZE,
                f"{self._topics[Role.DEPTH]} has {pixels.shape[1]} x {pixels.shape[0]} pixels, "
                f"{self._topics[Role.DEPTH_INFO]} describes {expected[1]} x {expected[0]}: use the "
                "depth camera's own info",
            )
        transform = self._transform(match.rgb, match.depth)
        if rectifier is not None:
            pixels = rectifier.depth(pixels)
        if self._settings.depth_kind == "ray":
            pixels = along_axis(pixels, camera.intrinsics)
        return register_depth(pixels, camera.intrinsics, transform, colour_camera.intrinsics)

    def _is_apart(self, rgb: AnyImage, depth: AnyImage) -> bool:
        return bool(
            self._settings.check_frame_ids
            and rgb.frame_id
            and depth.frame_id
            and plain_frame(rgb.frame_id) != plain_frame(depth.frame_id)
        )

    def _without_info(
        self, match: Match, pixels: NDArray[np.float32], colour_camera: CalibratedCamera
    ) -> FrameRefused:
        depth, info = self._topics[Role.DEPTH], self._topics[Role.DEPTH_INFO]
        if self._is_apart(match.rgb, match.depth):
            return FrameRefused(
                RefusalCause.FRAME_MISMATCH,
                f"{depth} is in frame {match.depth.frame_id!r}, colour in "
                f"{match.rgb.frame_id!r}: use depth aligned to colour, or publish "
                f"{info} and the transform (tf or capture.depth_to_rgb) "
                "to have it registered here, or turn off capture.check_frame_ids if it is aligned",
            )
        expected = colour_camera.intrinsics
        return FrameRefused(
            RefusalCause.SIZE,
            f"{depth} has {pixels.shape[1]} x {pixels.shape[0]} pixels, "
            f"{self._topics[Role.CAMERA_INFO]} describes {expected.width} x {expected.height}: use "
            f"depth aligned to colour, or publish {info} to have it registered here",
        )

    def _transform(self, rgb: AnyImage, depth: AnyImage) -> NDArray[np.float64]:
        if self._T_rgb_depth is not None:
            return self._T_rgb_depth
        if not self._is_apart(rgb, depth):
            return np.eye(4)
        try:
            return self._transforms.matrix(rgb.frame_id, depth.frame_id, depth.stamp_ns)
        except FrameRefused as refusal:
            raise FrameRefused(
                refusal.cause,
                f"{self._topics[Role.DEPTH]} cannot be registered to colour: {refusal}; or set "
                "capture.depth_to_rgb",
            ) from refusal
