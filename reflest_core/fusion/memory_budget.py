"""How ``memory_budget_mb`` is shared between the volume, the observation store and the views.

The view table takes a fixed part. The rest is split so that every TSDF block comes with rows for
the surface voxels that a block of a smooth surface holds on average, blocks without surface
included. The frame that is being fused and snapshots are not counted.
"""

from __future__ import annotations

from dataclasses import dataclass

from reflest_core.fusion.observation_store import BYTES_PER_OBSERVATION, BYTES_PER_VOXEL
from reflest_core.fusion.settings import FusionSettings
from reflest_core.fusion.tsdf import BYTES_PER_BLOCK
from reflest_core.fusion.views import BYTES_PER_VIEW, VIEW_CAPACITY

SURFACE_VOXELS_PER_BLOCK = 32


@dataclass(frozen=True)
class MemoryBudget:
    """Capacities whose arrays together never pass the budget."""

    blocks: int
    voxels: int
    views: int

    @classmethod
    def from_settings(cls, settings: FusionSettings) -> MemoryBudget:
        """The capacities that ``memory_budget_mb`` (of 10^6 bytes) pays for."""
        budget = int(settings.memory_budget_mb * 1e6) - VIEW_CAPACITY * BYTES_PER_VIEW
        row = BYTES_PER_VOXEL + BYTES_PER_OBSERVATION * settings.observations_per_voxel
        blocks = budget // (BYTES_PER_BLOCK + SURFACE_VOXELS_PER_BLOCK * row)
        return cls(blocks, blocks * SURFACE_VOXELS_PER_BLOCK, VIEW_CAPACITY)
