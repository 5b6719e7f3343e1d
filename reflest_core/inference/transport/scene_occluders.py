# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the voxels of a scene hide from each other, and the light that comes from there instead.

As in :mod:`.visibility`, surfels cover each other's view by patch (Bunnell 2005, "Dynamic Ambient
Occlusion and Indirect Lighting"); here every surfel has a colour of its own. Things are solid:
where more of a patch is covered by surfels that face away than by those that face the voxel, the
side in between was not scanned, as that of things on a table, and hides the light all the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reflest_core.inference.transport.patch_grid import EDGE, patch_shares
from reflest_core.inference.transport.visibility import FLATTEST, LEAST_SHARE, Sight
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.octahedral import octahedral_texel
from reflest_core.surface.extent import NEIGHBOURS

SURFELS = 1500
"""About so many stand for a scene, whatever its size."""
MEASURED = 512
"""Voxels about which the distance to neighbours is measured."""
BACK = 0.3
"""Radiance of an underside that was never scanned, as a share of what is seen from above."""


@dataclass(frozen=True)
class SceneOccluders:
    """Surfels that stand for a scene.

    Attributes:
        positions: (D, 3) float32, metres.
        normals: (D, 3) float32, unit.
        areas: (D,) float32, square metres.
        colours: (D, 3) float32, linear radiance that they send.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    areas: NDArray[np.float32]
    colours: NDArray[np.float32]

    @staticmethod
    def of(
        positions: NDArray[np.float32],
        normals: NDArray[np.float32],
        colours: NDArray[np.float32],
    ) -> SceneOccluders:
        """Average the voxels of equal cells and similar normals.

        Args:
            positions: (V, 3) metres.
            normals: (V, 3) unit.
            colours: (V, 3) linear radiance.
        """
        area = _voxel_area(positions)
        cell = math.sqrt(max(len(positions), 1) * area / SURFELS)
        group, groups = cell_groups(positions, normals, max(cell, 1e-6))
        counts = np.bincount(group, minlength=groups)

        def mean(values: NDArray[np.float32]) -> NDArray[np.float64]:
            sums = [np.bincount(group, values[:, k], groups) for k in range(3)]
            return np.asarray(np.stack(sums, axis=1) / np.maximum(counts, 1)[:, None])

        facing = mean(normals)
        length = np.linalg.norm(facing, axis=1)
        return SceneOccluders(
            mean(positions).astype(np.float32),
            (facing / np.maximum(length, 1e-6)[:, None]).astype(np.float32),
            (counts * area * length).astype(np.float32),
            mean(colours).astype(np.float32),
        )

    def sight(
        self,
        positions: NDArray[np.float32],
        normals: NDArray[np.float32],
        weights: NDArray[np.float32],
    ) -> Sight:
        """Compute what voxels see.

        Args:
            positions: (V, 3) metres.
            normals: (V, 3) unit.
            weights: (V, SIZE * SIZE) of :func:`.cosine_weights`.
        """
        hidden, sent = _hidden_shares(
            kernel_array(self.positions, np.float32),
            kernel_array(self.normals, np.float32),
            kernel_array(self.areas, np.float32),
            kernel_array(self.colours, np.float32),
            kernel_array(positions, np.float32),
            kernel_array(normals, np.float32),
            EDGE,
        )
        shares = np.minimum(hidden / np.maximum(patch_shares(weights), LEAST_SHARE), 1.0)
        own = sent / np.maximum(hidden, np.float32(1e-9))[..., None]
        return Sight(np.asarray(1.0 - shares, np.float32), np.asarray(own, np.float32))


def _voxel_area(positions: NDArray[np.float32]) -> float:
    """Square metres of surface for each voxel, by the distance to their sixth neighbours."""
    if len(positions) <= NEIGHBOURS:
        return 0.0
    some = positions[:: max(len(positions) // MEASURED, 1)]
    distances, _ = cKDTree(positions).query(some, k=NEIGHBOURS + 1)
    return math.pi * float(np.median(distances[:, -1])) ** 2 / NEIGHBOURS


def cell_groups(
    positions: NDArray[np.float32], normals: NDArray[np.float32], cell: float
) -> tuple[NDArray[np.int64], int]:
    """Group voxels by a cubic cell and the axis that their normal is nearest to.

    Args:
        positions: (V, 3) metres.
        normals: (V, 3) unit.
        cell: edge in metres.

    Returns:
        (V,) the group of each voxel, and how many groups there are.
    """
    cells = np.floor(positions / np.float32(cell)).astype(np.int64)
    cells -= cells.min(axis=0, initial=0)
    axis = np.abs(normals).argmax(axis=1)
    side = 2 * axis + (np.take_along_axis(normals, axis[:, None], axis=1)[:, 0] < 0.0)
    extent = cells.max(axis=0, initial=0) + 1
    code = ((cells[:, 0] * extent[1] + cells[:, 1]) * extent[2] + cells[:, 2]) * 6 + side
    groups, group = np.unique(code, return_inverse=True)
    return group.reshape(-1), len(groups)


@compiled
def _hidden_shares(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    areas: NDArray[np.float32],
    colours: NDArray[np.float32],
    of_positions: NDArray[np.float32],
    of_normals: NDArray[np.float32],
    edge: int,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(V, P) share of the hemisphere that is covered, and (V, P, 3) that times the radiance."""
    voxels, patches = len(of_positions), edge * edge
    hidden = np.zeros((voxels, patches), np.float32)
    sent = np.zeros((voxels, patches, 3), np.float32)
    sides = np.zeros((2, patches, 4), np.float32)
    for voxel in range(voxels):
        sides[:] = 0.0
        for surfel in range(len(positions)):
            x = positions[surfel, 0] - of_positions[voxel, 0]
            y = positions[surfel, 1] - of_positions[voxel, 1]
            z = positions[surfel, 2] - of_positions[voxel, 2]
            above = x * of_normals[voxel, 0] + y * of_normals[voxel, 1] + z * of_normals[voxel, 2]
            square = x * x + y * y + z * z
            if above <= 0.0 or above * above < FLATTEST * FLATTEST * square:
                continue
            facing = -(x * normals[surfel, 0] + y * normals[surfel, 1] + z * normals[surfel, 2])
            distance = math.sqrt(square)
            row, column = octahedral_texel(x, y, z, edge)
            # A surfel close by covers no more than half of all directions.
            angle = areas[surfel] * abs(facing) / distance
            angle /= square + areas[surfel] / (2.0 * math.pi)
            share = angle * above / distance / math.pi
            side = sides[0 if facing > 0.0 else 1, row * edge + column]
            side[3] += share
            for channel in range(3):
                side[channel] += share * colours[surfel, channel]
        for patch in range(patches):
            front, back = sides[0, patch], sides[1, patch]
            beyond = max(back[3] - front[3], 0.0)
            hidden[voxel, patch] = front[3] + beyond
            of_back = BACK * beyond / max(back[3], 1e-9)
            for channel in range(3):
                sent[voxel, patch, channel] = front[channel] + of_back * back[channel]
    return hidden, sent
