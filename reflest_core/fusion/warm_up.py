# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Compile fusion's kernels, or load them from the cache, before frames wait for them."""

from __future__ import annotations

import dataclasses

import numpy as np

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.frame import Frame
from reflest_core.fusion.observations.eviction import least_worthy
from reflest_core.fusion.poses.agreement import DepthSample
from reflest_core.fusion.poses.colours import PlacedFrame
from reflest_core.fusion.poses.distant_views import View, ViewPairs
from reflest_core.fusion.poses.edge_maps import EdgeMaps
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.tsdf.tsdf_blocks import erase_blocks, surface_keys
from reflest_core.light.exposure_correction import at_one_exposure

BUDGET_MB = 16.0


def warm_up() -> None:
    """Run every kernel once on a small wall. Takes a second; about a minute on a first start."""
    camera = CameraIntrinsics(width=32, height=24, fx=30.0, fy=30.0, cx=15.5, cy=11.5)
    wall = Frame(
        stamp_ns=1,
        rgb=np.zeros((24, 32, 3), np.uint8),
        depth=np.ones((24, 32), np.float32),
        T_world_camera=np.eye(4),
        intrinsics=camera,
    )
    region = RegionSettings("box", (0.0, 0.0, 1.0), (1.0, 1.0, 1.0))
    settings = FusionSettings(
        voxel_size=0.02, memory_budget_mb=BUDGET_MB, frames_per_view=1, normal_smoothing=25.0
    )
    scan = Scan(settings, region)
    scan.region.contains(np.zeros((1, 3)))
    for stamp_ns in (1, 2, 3):  # the second adds to the first's view, the third may be redundant
        scan.fuse(dataclasses.replace(wall, stamp_ns=stamp_ns))
    scan.snapshot()
    sample = DepthSample(wall)
    sample.meets(sample, np.eye(4))
    placed = PlacedFrame(wall, sample)
    placed.colours_meet(placed)
    EdgeMaps.of(wall)
    ViewPairs([View(sample), View(sample)])
    at_one_exposure(np.zeros((1, 3), np.uint8), np.full(1, 2.0, np.float32), np.zeros(1, np.uint16))
    scan.store.drop_views(np.array([0]))
    least_worthy(scan.store.rows.last_seen, scan.store.rows.counts, 0, 0, 0)
    nothing = np.empty(0, np.int64)
    surface_keys(nothing, scan.volume.blocks)
    erase_blocks(nothing, scan.volume.blocks, scan.volume.count)
    scan.volume.restore(scan.volume.count)


if __name__ == "__main__":
    warm_up()
