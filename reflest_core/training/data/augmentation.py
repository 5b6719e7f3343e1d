# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How training scenes are varied without untruth: fewer views and voxels, turns, swaps."""

from __future__ import annotations

import dataclasses
import math


@dataclasses.dataclass(frozen=True)
class Augmentation:
    """How far training scenes are varied; :mod:`.drawn_scenes` does it.

    ``views``: least and most views kept of a scene. ``candidates``: random voxels from which those
    of a minibatch are chosen, ``spread`` as in an estimate or else at random. ``azimuth``:
    hemisphere images turn by up to this many radians either way. ``channel_swap``: permute the
    colour channels of light and material alike. The world always turns about the vertical.
    """

    views: tuple[int, int] = (5, 100)
    candidates: int = 120
    spread: bool = True
    azimuth: float = math.pi / 6
    channel_swap: bool = True
