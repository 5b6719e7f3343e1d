# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How ``memory_budget_mb`` is shared between the volume, the observation store and the views.

The view table and the light map take fixed parts. The rest is split so that every TSDF block comes
with rows for the surface voxels that a block of a smooth surface holds on average, blocks without
surface included, and every row with chunks for a voxel that is often seen. The frame that is being
fused and snapshots are not in the budget, but bounded too (``WORKING_MB``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from reflest_core.errors import ReflestError
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

BYTES_PER_MATERIAL_KEY = 16
"""In a scan's file: a voxel's key and the id of its material."""
MOST_BESIDE = 1 << 21
"""Bytes of a scan's file for the header and what the archive adds to its arrays."""

OBSERVATIONS_PER_VOXEL = 24
"""For which there is room on average; some voxels have more and others less."""


class MemoryBudgetError(ReflestError):
    """The machine cannot give what ``memory_budget_mb`` asks for, or a scan needs more."""

    @classmethod
    def of(cls, settings: FusionSettings) -> MemoryBudgetError:
        """Say that the machine cannot give the budget.

        Args:
            settings: With the budget.
        """
        return cls(
            f"memory_budget_mb = {settings.memory_budget_mb:g} MB is more than this machine can "
            "give: lower it"
        )


@dataclass(frozen=True)
class MemoryBudget:
    """Capacities whose arrays together never pass the budget.

    Attributes:
        blocks: TSDF blocks.
        voxels: Rows of the observation store.
        chunks: Chunks of observations.
        views: Rows of the view table.
        megabytes: The budget, 10^6 bytes.
    """

    blocks: int
    voxels: int
    chunks: int
    views: int
    megabytes: float

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
        return cls(blocks, voxels, voxels * chunks, VIEW_CAPACITY, settings.memory_budget_mb)

    def check_size(self, path: Path, size: int) -> None:
        """Check that a file is no larger than a scan that fits can be.

        Args:
            path: The scan's file, for the message.
            size: Of the file, bytes.

        Raises:
            MemoryBudgetError: It is larger.
        """
        if size > self.megabytes * 1e6 + BYTES_PER_MATERIAL_KEY * self.voxels + MOST_BESIDE:
            raise self._too_small(path)

    def check_room(self, path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Check that a saved scan fits.

        Args:
            path: The scan's file, for the message.
            arrays: The scan's arrays by name.

        Raises:
            MemoryBudgetError: It does not fit.
        """
        for name, room in (
            ("volume_keys", self.blocks),
            ("store_keys", self.voxels),
            ("chunks_after", self.chunks),
            ("views_order", self.views),
            ("material_keys", self.voxels),
        ):
            if name in arrays and len(arrays[name]) > room:
                raise self._too_small(path)

    def _too_small(self, path: Path) -> MemoryBudgetError:
        return MemoryBudgetError(
            f"the scan in {path} does not fit memory_budget_mb = {self.megabytes:g} MB: "
            "raise it, and restart the node if it is a node's"
        )
