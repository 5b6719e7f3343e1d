# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Ids of materials that stay the same from keyframe to keyframe."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from reflest_core.surface.material_ids import FIRST_ID, MOST_IDS, GivenIds

MOST_MATERIALS = 256
"""Of one map; what a message holds."""
LEAST_SHARE = 0.25
"""A material keeps its id where the two share this much of the smaller one's common voxels."""


@dataclass
class MaterialIds:
    """Matches materials with those of the keyframe before; memory is bounded by its voxels.

    Attributes:
        given: ids of the last keyframe's voxels.
    """

    given: GivenIds = field(default_factory=GivenIds)

    def match(self, keys: NDArray[np.int64], labels: NDArray[np.int64]) -> NDArray[np.int64]:
        """Give each material the id of the earlier one that it overlaps most; new ids to the rest.

        An id goes to one material at most and, once its material is gone, is not given again.
        After :data:`.MOST_IDS` all ids begin again at the first one.

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
        is_new, next_id = ids < 0, self.given.next_id
        if next_id + int(is_new.sum()) > MOST_IDS:
            is_new[:], next_id = True, FIRST_ID
        ids[is_new] = next_id + np.arange(int(is_new.sum()))
        self.given = GivenIds(keys, ids[labels], next_id + int(is_new.sum()))
        return ids

    def _matches(self, keys: NDArray[np.int64], labels: NDArray[np.int64]) -> list[tuple[int, int]]:
        """Pairs of material and earlier id, one to one, the largest overlap first."""
        known = self.given.keys
        place = np.searchsorted(known, keys)
        place[place == len(known)] = 0
        is_common = known[place] == keys if len(known) else np.zeros(len(keys), np.bool_)
        old, new = self.given.ids[place[is_common]], labels[is_common]
        pairs, overlaps = np.unique(np.stack([new, old], axis=1), axis=0, return_counts=True)
        new_sizes = dict(zip(*np.unique(new, return_counts=True), strict=True))
        old_sizes = dict(zip(*np.unique(old, return_counts=True), strict=True))
        found: list[tuple[int, int]] = []
        taken_new: set[int] = set()
        taken_old: set[int] = set()
        for n in np.lexsort((pairs[:, 0], pairs[:, 1], -overlaps)):
            material, earlier = pairs[n].tolist()
            least = LEAST_SHARE * min(new_sizes[material], old_sizes[earlier])
            if material in taken_new or earlier in taken_old or overlaps[n] < least:
                continue
            found.append((material, earlier))
            taken_new.add(material)
            taken_old.add(earlier)
        return found
