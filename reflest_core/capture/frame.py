# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One RGB-D view with its pose: what every capture yields and fusion takes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics


@dataclass(frozen=True)
class Frame:
    """A matched, decoded and checked frame.

    Attributes:
        stamp_ns: Stamp of the colour image, nanoseconds.
        rgb: (H, W, 3) uint8, 8-bit sRGB.
        depth: (H, W) float32, Z along the optical axis in metres, registered to ``rgb``; 0 where
            unknown.
        T_world_camera: (4, 4) float64, camera optical frame (z forward, x right, y down) to world.
        intrinsics: Of both images.
        mask: (H, W) bool, True on the scanned object; None where nobody published one.
        frame_id: Name of the camera's frame, "" where unknown.
        world_frame_id: Name of the world frame, "" where unknown.
        depth_source: What sentences call the depth image.
    """

    stamp_ns: int
    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    T_world_camera: NDArray[np.float64]
    intrinsics: CameraIntrinsics
    mask: NDArray[np.bool_] | None = None
    frame_id: str = ""
    world_frame_id: str = ""
    depth_source: str = "the depth image"

    @property
    def camera_centre(self) -> NDArray[np.float64]:
        """The camera centre in the world frame, (3,) metres."""
        return self.T_world_camera[:3, 3]

    def relative_to(self, origin: NDArray[np.float64]) -> Frame:
        """Return the frame in a world frame that is moved, not turned.

        Args:
            origin: (3,) of that frame, in this one's world frame, metres.

        Returns:
            The frame itself where the origin is 0.
        """
        if not origin.any():
            return self
        pose = self.T_world_camera.copy()
        pose[:3, 3] -= origin
        return replace(self, T_world_camera=pose)

    @cached_property
    def T_camera_world(self) -> NDArray[np.float64]:
        """The inverse of :attr:`T_world_camera`, (4, 4): world to camera optical frame."""
        return np.asarray(np.linalg.inv(self.T_world_camera), np.float64)
