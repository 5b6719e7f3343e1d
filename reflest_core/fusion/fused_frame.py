# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What one frame brought."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class FusedFrame:
    """What became of the frame, and what it cost.

    ``view``: the id of the view that the frame's observations belong to; None if it saw nothing.
    ``is_new_view``: False where it only filled in what the stored view ``view`` had missed.
    ``is_redundant``: it showed nothing that ``view`` had not (:mod:`redundancy`); the scan is as it
    was, and the counts below are 0. ``foreground``, ``background``: (3,) float32, F and B of the
    frame, mean 8-bit colour in [0, 255], NaN where unknown.

    ``blocks_looked_at``: TSDF blocks whose voxels were projected. ``blocks_changed``: those
    updated. ``surface_voxels``: found in them. ``voxels_seen``: those that the frame truly sees.
    ``observations_kept``: observations added by it. The last three are 0 where ``view`` knew so
    much of the frame that only its depth was fused.

    ``is_light_alone``: it looked away from the object, and showed the light that falls on it.
    """

    stamp_ns: int
    frame_id: str
    view: int | None
    is_new_view: bool
    is_redundant: bool
    foreground: NDArray[np.float32]
    background: NDArray[np.float32]
    blocks_looked_at: int
    blocks_changed: int
    surface_voxels: int
    voxels_seen: int
    observations_kept: int
    is_light_alone: bool = False
