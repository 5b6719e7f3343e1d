# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The camera that full images and sequences are seen through: a VGA depth camera's view."""

from __future__ import annotations

from reflest_core.capture.camera import CameraIntrinsics

FOCAL_LENGTH = 525.0 / 640.0
"""Of the image's width."""


def depth_camera(width: int, height: int) -> CameraIntrinsics:
    """A pinhole whose optical axis passes through the middle of the image."""
    focal = FOCAL_LENGTH * width
    return CameraIntrinsics(width, height, focal, focal, 0.5 * (width - 1), 0.5 * (height - 1))
