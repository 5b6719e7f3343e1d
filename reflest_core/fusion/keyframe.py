# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""When an estimate is due: the camera moved, turned, or enough image time passed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.settings import KeyframeSettings


class KeyframePolicy:
    """Remembers the last keyframe; the first frame that it is given is one."""

    def __init__(self, settings: KeyframeSettings) -> None:
        """Begin without a keyframe.

        Args:
            settings: How far and how long from one to the next.
        """
        self.settings = settings
        self._last: tuple[int, NDArray[np.float64]] | None = None

    def is_keyframe(self, stamp_ns: int, T_world_camera: NDArray[np.float64]) -> bool:
        """Decide on a frame; if it is a keyframe, it becomes the last one.

        Args:
            stamp_ns: The image's stamp, nanoseconds.
            T_world_camera: (4, 4) its pose.

        Returns:
            Whether this frame is a keyframe.
        """
        if self._last is not None:
            last_stamp_ns, last = self._last
            moved = float(np.linalg.norm(T_world_camera[:3, 3] - last[:3, 3]))
            turned = rotation_angle(last[:3, :3].T @ T_world_camera[:3, :3])
            waited = (stamp_ns - last_stamp_ns) * 1e-9
            if (
                moved < self.settings.translation
                and turned < self.settings.rotation
                and waited < self.settings.interval
            ):
                return False
        self._last = (stamp_ns, T_world_camera.copy())
        return True

    def reset(self) -> None:
        """Forget the last keyframe."""
        self._last = None


def rotation_angle(rotation: NDArray[np.float64]) -> float:
    """Return the angle of a rotation.

    Args:
        rotation: (3, 3) rotation.

    Returns:
        Degrees in [0, 180].
    """
    skew = rotation - rotation.T
    sine = 0.5 * math.sqrt(skew[2, 1] ** 2 + skew[0, 2] ** 2 + skew[1, 0] ** 2)
    cosine = 0.5 * (float(np.trace(rotation)) - 1.0)
    return math.degrees(math.atan2(sine, cosine))
