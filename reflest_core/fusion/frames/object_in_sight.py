# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where the scanned object is, and whether a frame can show it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame

LOOKED_AT = 4096
"""Voxels at most that stand for the object."""
MARGIN = 0.1
"""Of the image's size: so near to its edge the object counts as in sight."""


@dataclass(frozen=True)
class KnownObject:
    """What was scanned so far.

    ``positions``: (V, 3) float32 of some of its surface voxels, world frame, metres.
    """

    positions: NDArray[np.float32]

    @staticmethod
    def of(positions: NDArray[np.float32]) -> KnownObject:
        """That of all surface voxels (N, 3); at least one."""
        return KnownObject(positions[:: max(len(positions) // LOOKED_AT, 1)])

    @property
    def centre(self) -> NDArray[np.float64]:
        """(3,) the mean position."""
        return np.asarray(self.positions.mean(axis=0, dtype=np.float64))

    @property
    def radius(self) -> float:
        """Metres: root mean square distance from the centre."""
        return float(np.sqrt(self.positions.var(axis=0, dtype=np.float64).sum()))

    def is_in_sight(self, frame: Frame) -> bool:
        """Whether any of it lies in the frame's field of view, hidden or not."""
        camera, T = frame.intrinsics, frame.T_world_camera
        x, y, z = ((self.positions - T[:3, 3]) @ T[:3, :3]).T
        before = z > 0.0
        u = camera.fx * x[before] / z[before] + camera.cx
        v = camera.fy * y[before] / z[before] + camera.cy
        across, down = MARGIN * camera.width, MARGIN * camera.height
        inside = (u > -across) & (u < camera.width + across)
        return bool((inside & (v > -down) & (v < camera.height + down)).any())
