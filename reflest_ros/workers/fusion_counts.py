# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Counters of the fusion thread, for the diagnostics."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from reflest_core.capture.messages import Role
from reflest_core.fusion.observations.exposure import exposure_drift
from reflest_core.fusion.scan import Scan


@dataclass
class FusionCounts:
    """Written by the fusion worker, read by the diagnostics.

    Attributes:
        messages: Messages received by role.
        matched: Colour images that found depth, calibration and pose.
        fused: Frames that went into the scan.
        redundant: Frames among the fused that showed nothing new, so that nothing was done.
        light_alone: Frames among the fused that showed the surroundings only.
        keyframes: Frames at which an estimate was due.
        dropped: Messages that came while the queue was full.
        discarded: Messages that waited when a reset or another region began a new scan.
        voxels: Surface voxels in the store.
        observations: Observations in the store.
        views: Views in the store.
        nbytes: Bytes reserved by the scan.
        fill: Share of the store's budget in use, 0 to 1.
        exposure_drift: Stops, NaN where unknown.
        exposure_gain: Correction of the last frame, a factor on linear colour.
        light_seen: Share of all directions in which the light was seen.
        fusion_seconds: That the last frame took to fuse, its snapshot included.
    """

    messages: dict[Role, int] = field(default_factory=lambda: dict.fromkeys(Role, 0))
    matched: int = 0
    fused: int = 0
    redundant: int = 0
    light_alone: int = 0
    keyframes: int = 0
    dropped: int = 0
    discarded: int = 0
    voxels: int = 0
    observations: int = 0
    views: int = 0
    nbytes: int = 0
    fill: float = 0.0
    exposure_drift: float = math.nan
    exposure_gain: float = 1.0
    light_seen: float = 0.0
    fusion_seconds: float = math.nan

    def take_store(self, scan: Scan) -> None:
        """Note how full the scan is.

        Args:
            scan: The current scan.
        """
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
        """Compare the views' brightness and sum up the light; once a keyframe is enough.

        Args:
            scan: The current scan.
        """
        self.exposure_drift = exposure_drift(scan.views)
        self.light_seen = scan.light.seen_share
