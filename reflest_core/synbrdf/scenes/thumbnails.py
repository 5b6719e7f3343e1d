# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A small image of every view of a scene: what the camera saw of the object's surroundings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.light import rgbe

THUMBNAIL = CameraIntrinsics(48, 36, 39.4, 39.4, 23.5, 17.5)
"""A VGA depth camera's view in 48 x 36 pixels."""


@dataclass(frozen=True)
class Thumbnails:
    """One image of each of W views, through the intrinsics :data:`THUMBNAIL`.

    Attributes:
        rgbe: (W, 36, 48, 4) uint8, linear sRGB radiance.
        is_object: (W, 36, 48) bool; elsewhere the light itself is seen.
        T_world_camera: (W, 4, 4) float32.
        depth: (W, 36, 48) uint16, millimetres along the optical axis as a depth camera sees them, 0
            where it measures nothing; None where all that is not the object is infinitely far.
    """

    rgbe: NDArray[np.uint8]
    is_object: NDArray[np.bool_]
    T_world_camera: NDArray[np.float32]
    depth: NDArray[np.uint16] | None = None

    def radiance(self) -> NDArray[np.float32]:
        """(W, 36, 48, 3) linear sRGB, in the unit of the scene's observations."""
        return rgbe.decode(self.rgbe)

    def of_views(self, views: NDArray[np.int64]) -> Thumbnails:
        """The thumbnails of some views.

        Args:
            views: (N,) indices.
        """
        return Thumbnails(
            self.rgbe[views],
            self.is_object[views],
            self.T_world_camera[views],
            None if self.depth is None else self.depth[views],
        )
