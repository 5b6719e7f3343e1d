# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which voxel is of which material."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.selection import keep_voxels

UNASSIGNED = 0
"""Id of voxels that are of no material."""
WHOLE = 1
"""Id of the only material of the partition ``whole``."""


@dataclass(frozen=True)
class Partition:
    """Maps voxel keys to material ids.

    Attributes:
        keys: (N,) int64, rising, each once: packed keys of voxels
            (:mod:`reflest_core.surface.voxel_key`), or the indices of a surface without keys.
        material_ids: (N,) uint32; :data:`UNASSIGNED` for voxels of no material.
    """

    keys: NDArray[np.int64]
    material_ids: NDArray[np.uint32]

    def __post_init__(self) -> None:
        """Check shapes and order.

        Raises:
            ValueError: The arrays differ in length, or the keys do not rise.
        """
        if self.keys.shape != self.material_ids.shape or self.keys.ndim != 1:
            raise ValueError(
                f"keys {self.keys.shape} and material_ids {self.material_ids.shape} of a "
                "partition must be one-dimensional and of one length"
            )
        if len(self.keys) > 1 and not (np.diff(self.keys) > 0).all():
            raise ValueError("the keys of a partition must rise and occur once each")

    @staticmethod
    def of(surface: ObservedSurface, material_ids: NDArray[np.integer]) -> Partition:
        """Assign an id to each voxel of a surface.

        Args:
            surface: V voxels.
            material_ids: (V,) ids, one for each voxel.
        """
        keys = surface.voxel_keys
        order = np.argsort(keys, kind="stable")
        return Partition(keys[order], np.asarray(material_ids)[order].astype(np.uint32))

    @staticmethod
    def whole(surface: ObservedSurface) -> Partition:
        """Take all voxels of a surface for one material, :data:`WHOLE`.

        Args:
            surface: V voxels.
        """
        return Partition.of(surface, np.full(surface.voxel_count, WHOLE, np.uint32))

    @property
    def ids(self) -> tuple[int, ...]:
        """The ids that occur, rising, without :data:`UNASSIGNED`."""
        return tuple(int(i) for i in np.unique(self.material_ids) if i != UNASSIGNED)

    def ids_of(self, keys: NDArray[np.int64]) -> NDArray[np.uint32]:
        """Look up voxels.

        Args:
            keys: (V,) voxel keys in any order.

        Returns:
            (V,) material ids; :data:`UNASSIGNED` for keys that the partition does not hold.
        """
        if not len(self.keys):
            return np.zeros(len(keys), np.uint32)
        places = np.minimum(np.searchsorted(self.keys, keys), len(self.keys) - 1)
        found = np.where(self.keys[places] == keys, self.material_ids[places], UNASSIGNED)
        return found.astype(np.uint32)

    def parts(self, surface: ObservedSurface) -> Iterator[tuple[int, ObservedSurface]]:
        """Cut a surface into its materials.

        Args:
            surface: any surface; its voxels that the partition does not hold belong to no part.

        Yields:
            Each id, rising, with the surface of its voxels in the order they had. A material of
            all voxels is the surface itself; ids without a voxel of the surface are left out.
        """
        ids = self.ids_of(surface.voxel_keys)
        for material_id in self.ids:
            voxels = np.flatnonzero(ids == material_id)
            if len(voxels) == surface.voxel_count:
                yield material_id, surface
            elif len(voxels):
                yield material_id, keep_voxels(surface, voxels)
