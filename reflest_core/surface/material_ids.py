# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The material ids that a scan's voxels have, as they outlive a keyframe and a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

FIRST_ID = 1
MOST_IDS = 2**32 - 1
"""What a message and a PLY file hold."""


@dataclass(frozen=True)
class GivenIds:
    """Ids of materials by voxel; no id of a scan is given twice.

    Attributes:
        keys: (N,) int64, voxel keys, rising, each once.
        ids: (N,) int64, the material of each.
        next_id: the first id that was never given.
    """

    keys: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    ids: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    next_id: int = FIRST_ID

    def __post_init__(self) -> None:
        """Check what may come from a file.

        Raises:
            ValueError: Types, shapes or order are wrong, or an id was not given yet.
        """
        if any(one.dtype != np.int64 or one.ndim != 1 for one in (self.keys, self.ids)):
            raise ValueError("voxel keys and material ids must be one-dimensional int64")
        if len(self.keys) != len(self.ids):
            raise ValueError(f"{len(self.keys)} voxel keys have {len(self.ids)} material ids")
        if (np.diff(self.keys) <= 0).any():
            raise ValueError("the voxel keys of material ids do not rise")
        if type(self.next_id) is not int or not FIRST_ID <= self.next_id <= MOST_IDS:
            raise ValueError("the next material id is out of range")
        if len(self.ids) and not (
            int(self.ids.min()) >= FIRST_ID and int(self.ids.max()) < self.next_id
        ):
            raise ValueError("a material id was never given")

    @staticmethod
    def stored(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> GivenIds:
        """Read the ids of a scan file.

        Args:
            header: the file's header.
            arrays: the file's arrays.

        Returns:
            The ids; none for a file that was written before ids were stored.

        Raises:
            ValueError: they cannot be right.
        """
        keys, ids = arrays.get("material_keys"), arrays.get("material_ids")
        if keys is None and ids is None:
            return GivenIds()
        if keys is None or ids is None:
            raise ValueError("its voxels' material ids are incomplete")
        return GivenIds(keys, ids, header.get("next_material_id", 0))

    @property
    def arrays(self) -> dict[str, NDArray[np.int64]]:
        """What :meth:`stored` reads, beside ``next_material_id`` in the header."""
        return {"material_keys": self.keys, "material_ids": self.ids}
