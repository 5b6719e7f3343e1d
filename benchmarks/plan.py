# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How much is measured: the sizes of every measurement, in one place."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Plan:
    """Sizes of the measurements.

    ``frame_path``: frames through the whole path; ``peer_frames``: those that Open3D fuses too;
    ``memory_frames``: those whose stages' memory is measured, untimed. ``estimates``: of each
    model; ``growth_estimates``: of each model and size. ``is_compiled``: compare
    with ``torch.compile`` too. ``growth_frames``: for each of the
    ``voxel_sizes`` (mm), ``resolutions`` and regions. ``store_voxels``: sizes of a store at
    ``store_voxel_size`` mm. ``view_counts``: views of a scan. ``memory_strip``: frames along a
    floor too large for ``memory_budget_mb``. ``starts``: fresh processes that start up.
    ``live_seconds``: of the bag that is played to the node.
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

    @property
    def live_frames(self) -> int:
        """Frames of the bag."""
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
