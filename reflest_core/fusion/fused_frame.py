# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What one frame brought."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class FusedFrame:
    """What was done with a frame, and what it cost.

    Attributes:
        stamp_ns: The image's stamp, nanoseconds.
        frame_id: The camera's frame.
        foreground: (3,) float32, mean 8-bit colour F of the frame in [0, 255]; NaN where unknown.
        background: (3,) float32, the same for B.
        view: Id of the view that the frame's observations belong to; None if it saw nothing.
        is_new_view: False where the frame only added to the stored view ``view``.
        is_redundant: It showed nothing that ``view`` had not (:mod:`.redundancy`); the scan is as
            it was, and the counts are 0.
        is_light_alone: It looked away from the surface and showed the light that falls on it.
        blocks_projected: TSDF blocks whose voxels were projected.
        blocks_changed: Blocks that were updated.
        surface_voxels: Surface voxels found in them; this and the following counts are 0 where
            ``view`` knew so much of the frame that only its depth was fused.
        voxels_seen: Voxels that the frame truly sees.
        observations_kept: Observations that it added.
    """

    stamp_ns: int
    frame_id: str
    foreground: NDArray[np.float32]
    background: NDArray[np.float32]
    view: int | None = None
    is_new_view: bool = False
    is_redundant: bool = False
    is_light_alone: bool = False
    blocks_projected: int = 0
    blocks_changed: int = 0
    surface_voxels: int = 0
    voxels_seen: int = 0
    observations_kept: int = 0
