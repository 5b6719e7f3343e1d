# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Camera poses as a tracker reports them: near the truth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from reflest_core.synbrdf.realism.colour_drift import WANDER_RMS
from reflest_core.synbrdf.realism.settings import Realism
from reflest_core.synbrdf.scenes.views import smooth_noise

FRAME_SHARE = 0.5
"""Of the error's stddev that is new in every frame; the rest wanders slowly."""


def jittered(
    poses: NDArray[np.float64], realism: Realism, rng: np.random.Generator
) -> NDArray[np.float64]:
    """``T_world_camera`` (W, 4, 4) with errors of position and, about the camera, of direction.

    Args:
        poses: (W, 4, 4) true ``T_world_camera``.
        realism: which faults, and how strong.
        rng: random numbers; the same state draws the same.
    """
    count = len(poses)
    degree = rng.uniform()
    error = FRAME_SHARE * rng.normal(size=(count, 6))
    error += (1.0 - FRAME_SHARE**2) ** 0.5 * smooth_noise(rng, count, 6) / WANDER_RMS
    turns = Rotation.from_rotvec(np.deg2rad(realism.pose_rotation) * degree * error[:, 3:])
    moved = poses.copy()
    moved[:, :3, :3] = poses[:, :3, :3] @ turns.as_matrix()
    moved[:, :3, 3] += realism.pose_translation * degree * error[:, :3]
    return moved
