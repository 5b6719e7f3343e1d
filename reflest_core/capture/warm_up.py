# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Compile capture's kernels, or load them from the cache, and fill tables, before messages wait."""

from __future__ import annotations

import numpy as np

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.images.decode import decode_depth
from reflest_core.capture.images.depth_registration import register_depth
from reflest_core.capture.images.rvl import decode_rvl
from reflest_core.capture.messages import ImageMessage
from reflest_core.capture.settings import CaptureSettings


def warm_up() -> None:
    """Run every kernel once, and decode a depth image of the default unit."""
    pixel = CameraIntrinsics(width=1, height=1, fx=1.0, fy=1.0, cx=0.0, cy=0.0)
    register_depth(np.ones((1, 1), np.float32), pixel, np.eye(4), pixel)
    decode_rvl(bytes(4), 1, 1)
    depth = ImageMessage(0, "", 1, 1, "16UC1", False, 2, bytes(2))
    decode_depth(depth, "", CaptureSettings().depth_unit())
