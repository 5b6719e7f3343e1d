# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How ``memory_budget_mb`` is shared between the volume, the observation store and the views.

The view table and the light map take fixed parts. The rest is split so that every TSDF block comes
with rows for the surface voxels that a block of a smooth surface holds on average, blocks without
surface included, and every row with chunks for a voxel that is often seen. The frame that is being
fused and snapshots are not in the budget, but bounded too (``WORKING_MB``).
"""

from __future__ import annotations

from dataclasses import dataclass

from reflest_core.fusion.observations.observation_chunks import BYTES_PER_CHUNK, CHUNK
from reflest_core.fusion.observations.observation_store import BYTES_PER_VOXEL
from reflest_core.fusion.observations.views import BYTES_PER_VIEW, VIEW_CAPACITY
from reflest_core.fusion.settings import FusionSettings
from reflest_core.fusion.tsdf.volume import BYTES_PER_BLOCK
from reflest_core.light.light_map import BYTES_OF_LIGHT

WORKING_MB = 48.0
"""What a process takes beyond the budget while it fuses VGA frames, in 10^6 bytes: images, what is
worked out from them, and a snapshot."""

SURFACE_VOXELS_PER_BLOCK = 32

OBSERVATIONS_PER_VOXEL = 24
"""For which there is room on average; some voxels have more and others less."""


@dataclass(frozen=True)
class MemoryBudget:
    """Capacities whose arrays together never pass the budget.

    Attributes:
        blocks: TSDF blocks.
        voxels: Rows of the observation store.
        chunks: Chunks of observations.
        views: Rows of the view table.
    """

    blocks: int
    voxels: int
    chunks: int
    views: int

    @classmethod
    def from_settings(cls, settings: FusionSettings) -> MemoryBudget:
        """Divide ``memory_budget_mb`` (of 10^6 bytes) among the stages.

        Args:
            settings: The budget, and observations per voxel.

        Returns:
            The capacities.
        """
        fixed = VIEW_CAPACITY * BYTES_PER_VIEW + BYTES_OF_LIGHT
        budget = int(settings.memory_budget_mb * 1e6) - fixed
        chunks = -(-min(OBSERVATIONS_PER_VOXEL, settings.observations_per_voxel) // CHUNK)
        row = BYTES_PER_VOXEL + BYTES_PER_CHUNK * chunks
        blocks = budget // (BYTES_PER_BLOCK + SURFACE_VOXELS_PER_BLOCK * row)
        voxels = blocks * SURFACE_VOXELS_PER_BLOCK
        return cls(blocks, voxels, voxels * chunks, VIEW_CAPACITY)
