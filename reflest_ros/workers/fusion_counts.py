# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What fusion did so far, for the diagnostics."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from reflest_core.capture.messages import Role
from reflest_core.fusion.observations.exposure import exposure_drift
from reflest_core.fusion.scan import Scan


@dataclass
class FusionCounts:
    """Written by the fusion worker, read by the diagnostics.

    ``redundant``: frames among the fused that showed nothing new, so that nothing was done.
    ``light_alone``: those that looked away from the object.
    ``fill``: share of the store's budget in use. ``exposure_drift``: stops, NaN where unknown.
    ``exposure_gain``: of the last frame, by :meth:`.LightMap.add_frame`. ``light_seen``: share of
    all directions.
    """

    messages: dict[Role, int] = field(default_factory=lambda: dict.fromkeys(Role, 0))
    matched: int = 0
    fused: int = 0
    redundant: int = 0
    light_alone: int = 0
    keyframes: int = 0
    dropped: int = 0
    voxels: int = 0
    observations: int = 0
    views: int = 0
    nbytes: int = 0
    fill: float = 0.0
    exposure_drift: float = math.nan
    exposure_gain: float = 1.0
    light_seen: float = 0.0

    def take_store(self, scan: Scan) -> None:
        """Note how full the scan is."""
        self.voxels = scan.voxel_count
        self.observations = scan.observation_count
        self.views = scan.view_count
        self.nbytes = scan.nbytes
        self.fill = scan.fill
        self.exposure_gain = scan.light.gain
        if self.views == 0:
            self.exposure_drift = math.nan
            self.light_seen = 0.0

    def take_light(self, scan: Scan) -> None:
        """Compare the views' brightness, sum up the light; a keyframe is often enough."""
        self.exposure_drift = exposure_drift(scan.views)
        self.light_seen = scan.light.seen_share
