"""What one frame brought."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class FusedFrame:
    """``view``: the id of the view that the frame's observations belong to; None if it saw nothing.

    ``is_new_view``: False where the frame was redundant, so that it only filled in what the stored
    view ``view`` had missed. ``foreground``, ``background``: (3,) float32, F and B of the frame,
    mean 8-bit colour in [0, 255], NaN where unknown. ``blocks_changed``: TSDF blocks updated.
    ``voxels_seen``: surface voxels that the frame truly sees. ``observations_kept``: observations
    added by it.
    """

    stamp_ns: int
    frame_id: str
    view: int | None
    is_new_view: bool
    foreground: NDArray[np.float32]
    background: NDArray[np.float32]
    blocks_changed: int
    voxels_seen: int
    observations_kept: int
