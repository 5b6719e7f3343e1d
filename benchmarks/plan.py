# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The sizes of all measurements."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Plan:
    """Sizes of the measurements.

    Attributes:
        resolution: Width and height of the recording, pixels.
        rate: Frames per second.
        threads: Numbers of threads that the frame path is measured with.
        frame_path: Frames through the whole path.
        peer_frames: Frames that Open3D fuses too.
        memory_frames: Frames for the memory of the stages, not timed.
        estimates: Estimates of each model.
        growth_estimates: Estimates of each model and size.
        is_compiled: Also compare with ``torch.compile``.
        growth_frames: Frames for each voxel size, resolution and region.
        voxel_sizes: Millimetres.
        resolutions: Pairs of width and height.
        store_voxels: Numbers of voxels of the scanned floors.
        store_voxel_size: Their voxel size, millimetres.
        view_counts: Numbers of views of a scan.
        starts: Fresh processes that start up.
        memory_strip: Frames along a floor that is too large for the budget.
        memory_budget_mb: 10^6 bytes.
        live_seconds: Duration of the bag that is played to the node.
        exports: Times that the scene is exported.
    """

    resolution: tuple[int, int] = (640, 480)
    rate: float = 30.0
    threads: tuple[int, ...] = (1, 2)
    frame_path: int = 600
    peer_frames: int = 120
    memory_frames: int = 40
    estimates: int = 200
    growth_estimates: int = 20
    is_compiled: bool = True
    growth_frames: int = 30
    voxel_sizes: tuple[float, ...] = (10.0, 5.0, 3.0)
    resolutions: tuple[tuple[int, int], ...] = ((320, 240), (640, 480), (1280, 720))
    store_voxels: tuple[int, ...] = (10_000, 100_000, 1_000_000)
    store_voxel_size: float = 5.0
    view_counts: tuple[int, ...] = (10, 100, 1000)
    starts: int = 3
    memory_strip: int = 60
    memory_budget_mb: float = 128.0
    live_seconds: float = 60.0
    exports: int = 3

    @property
    def live_frames(self) -> int:
        """Number of frames of the played bag."""
        return max(round(self.live_seconds * self.rate), self.frame_path)


FULL = Plan()
QUICK = Plan(
    frame_path=150,
    peer_frames=20,
    memory_frames=10,
    estimates=40,
    growth_estimates=5,
    growth_frames=8,
    store_voxels=(10_000, 100_000),
    view_counts=(10, 100),
    starts=1,
    memory_strip=20,
    live_seconds=10.0,
)
TINY = Plan(
    resolution=(160, 120),
    rate=10.0,
    threads=(1,),
    frame_path=12,
    peer_frames=3,
    memory_frames=3,
    estimates=2,
    growth_estimates=2,
    is_compiled=False,
    growth_frames=4,
    voxel_sizes=(20.0, 10.0),
    resolutions=((80, 60), (160, 120)),
    store_voxels=(500, 2000),
    store_voxel_size=20.0,
    view_counts=(3, 6),
    starts=1,
    memory_strip=4,
    memory_budget_mb=32.0,
    live_seconds=3.0,
)
"""Shows that everything is measured, not how fast it is."""
