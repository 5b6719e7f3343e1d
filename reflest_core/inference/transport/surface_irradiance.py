# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The irradiance of every voxel of a scene, by a table over normals and patches of light."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.transport.patch_grid import PATCHES, texels_of_patches
from reflest_core.inference.transport.scene_occluders import SceneOccluders, cell_groups
from reflest_core.inference.transport.visibility import Sight
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.completion import LightPyramid
from reflest_core.light.cosine_weights import SIZE, cosine_weights
from reflest_core.light.octahedral import octahedral_directions, octahedral_texels

NORMALS = 64
"""Edge of the octahedral map of normals: 3 degrees apart."""
CELL = 0.02
"""Metres within which voxels that face alike see the same of the scene."""


@dataclass(frozen=True)
class SurfaceSight:
    """What every voxel of a scene sees of the light; does not depend on the light itself.

    Attributes:
        normal_of: (V,) int64, the nearest normal of the table.
        group_of: (V,) int64, the row of ``sight``.
        sight: of each group's middle voxel.
    """

    normal_of: NDArray[np.int64]
    group_of: NDArray[np.int64]
    sight: Sight

    @staticmethod
    def of(
        positions: NDArray[np.float32], normals: NDArray[np.float32], occluders: SceneOccluders
    ) -> SurfaceSight:
        """Compute it at one voxel of each cell and side.

        Args:
            positions: (V, 3) metres.
            normals: (V, 3) unit.
            occluders: surfels of the whole scene.
        """
        group, groups = cell_groups(positions, normals, CELL)
        middle = _middle_members(group, groups)
        sight = occluders.sight(positions[middle], normals[middle], cosine_weights(normals[middle]))
        return SurfaceSight(octahedral_texels(normals, NORMALS), group, sight)


def surface_irradiance(light: LightPyramid, sight: SurfaceSight) -> NDArray[np.float32]:
    """Integrate the light over the cosine at every voxel.

    Args:
        light: the completed light.
        sight: what the voxels see of it.

    Returns:
        (V, 5): ``E / pi``, linear; then the seen and the clipped share of that light. What comes
        from the scene itself counts as seen.
    """
    by_patch, shares = _table()
    level = next(level for level in light.levels if len(level) == SIZE)
    texels = level.reshape(-1, 5)[texels_of_patches(SIZE)]
    table = np.asarray((by_patch @ texels).transpose(1, 0, 2), np.float32)
    return _gathered(
        kernel_array(table, np.float32),
        shares,
        sight.normal_of,
        kernel_array(sight.group_of, np.int64),
        kernel_array(sight.sight.visible, np.float32),
        kernel_array(sight.sight.own, np.float32),
    )


@cache
def _table() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(P, N, T) cosine weights of N normals for the texels of each patch; (N, P) their sums."""
    weights = cosine_weights(octahedral_directions(NORMALS).reshape(-1, 3))
    by_patch = np.ascontiguousarray(weights[:, texels_of_patches(SIZE)].transpose(1, 0, 2))
    return by_patch, np.ascontiguousarray(by_patch.sum(axis=-1).T)


@compiled
def _middle_members(group: NDArray[np.int64], groups: int) -> NDArray[np.int64]:
    counts, seen = np.zeros(groups, np.int64), np.zeros(groups, np.int64)
    middle = np.zeros(groups, np.int64)
    for member in group:
        counts[member] += 1
    for voxel in range(len(group)):
        if seen[group[voxel]] == counts[group[voxel]] // 2:
            middle[group[voxel]] = voxel
        seen[group[voxel]] += 1
    return middle


@compiled
def _gathered(
    table: NDArray[np.float32],
    shares: NDArray[np.float32],
    normal_of: NDArray[np.int64],
    group_of: NDArray[np.int64],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
) -> NDArray[np.float32]:
    gathered = np.zeros((len(normal_of), 5), np.float32)
    for voxel in range(len(normal_of)):
        n, g = normal_of[voxel], group_of[voxel]
        for patch in range(PATCHES):
            share = shares[n, patch]
            if share == 0.0:
                continue
            seen = visible[g, patch]
            hidden = share * (1.0 - seen)
            for k in range(5):
                gathered[voxel, k] += seen * table[n, patch, k]
            if hidden > 0.0:
                for channel in range(3):
                    gathered[voxel, channel] += hidden * own[g, patch, channel]
                gathered[voxel, 3] += hidden
    return gathered
