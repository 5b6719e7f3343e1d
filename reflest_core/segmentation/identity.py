# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Ids of materials that stay the same from keyframe to keyframe."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

MOST_MATERIALS = 256
"""Of one map; what a message holds."""
LEAST_SHARE = 0.25
"""A material keeps its id where the two share this much of the smaller one's common voxels."""
FIRST_ID = 1


@dataclass
class MaterialIds:
    """Matches materials with those of the keyframe before; memory is bounded by its voxels.

    Attributes:
        keys: (V,) int64, voxel keys of the last keyframe, rising.
        ids: (V,) int64, the material of each.
        next_id: the first id that was never given.
    """

    keys: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    ids: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    next_id: int = FIRST_ID

    def match(self, keys: NDArray[np.int64], labels: NDArray[np.int64]) -> NDArray[np.int64]:
        """Give each material the id of the earlier one that it overlaps most; new ids to the rest.

        An id goes to one material at most and, once its material is gone, is not given again.

        Args:
            keys: (V,) voxel keys, each one once, in any order.
            labels: (V,) material 0, 1, ... of each voxel, -1 for none.

        Returns:
            (M,) the id of each material up to the largest label. A label without voxels has an id
            too, so that ids do not depend on gaps.

        Raises:
            ValueError: there are more than :data:`MOST_MATERIALS` materials.
        """
        materials = int(labels.max(initial=-1)) + 1
        if materials > MOST_MATERIALS:
            raise ValueError(f"{materials} materials where at most {MOST_MATERIALS} are allowed")
        is_member = labels >= 0
        order = np.argsort(keys[is_member], kind="stable")
        keys, labels = keys[is_member][order], labels[is_member][order]
        ids = np.full(materials, -1, np.int64)
        for material, known in self._matches(keys, labels):
            ids[material] = known
        is_new = ids < 0
        ids[is_new] = self.next_id + np.arange(int(is_new.sum()))
        self.next_id += int(is_new.sum())
        self.keys, self.ids = keys, ids[labels]
        return ids

    def _matches(self, keys: NDArray[np.int64], labels: NDArray[np.int64]) -> list[tuple[int, int]]:
        """Pairs of material and earlier id, one to one, the largest overlap first."""
        place = np.searchsorted(self.keys, keys)
        place[place == len(self.keys)] = 0
        is_common = self.keys[place] == keys if len(self.keys) else np.zeros(len(keys), np.bool_)
        old, new = self.ids[place[is_common]], labels[is_common]
        pairs, overlaps = np.unique(np.stack([new, old], axis=1), axis=0, return_counts=True)
        new_sizes = dict(zip(*np.unique(new, return_counts=True), strict=True))
        old_sizes = dict(zip(*np.unique(old, return_counts=True), strict=True))
        found: list[tuple[int, int]] = []
        taken_new: set[int] = set()
        taken_old: set[int] = set()
        for n in np.lexsort((pairs[:, 0], pairs[:, 1], -overlaps)):
            material, known = pairs[n].tolist()
            least = LEAST_SHARE * min(new_sizes[material], old_sizes[known])
            if material in taken_new or known in taken_old or overlaps[n] < least:
                continue
            found.append((material, known))
            taken_new.add(material)
            taken_old.add(known)
        return found
