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

from reflest_core.inference.transport.patch_grid import EDGE, PATCHES, patch_shares
from reflest_core.inference.transport.visibility import FLATTEST, LEAST_SHARE, Sight
from reflest_core.jit import compiled, kernel_array, vectorised
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
        surfels = np.concatenate([self.positions.T, self.normals.T, self.areas[None]])
        hidden, sent = _hidden_shares(
            kernel_array(surfels, np.float32),
            kernel_array(self.colours, np.float32),
            kernel_array(positions, np.float32),
            kernel_array(normals, np.float32),
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
    surfels: NDArray[np.float32],
    colours: NDArray[np.float32],
    of_positions: NDArray[np.float32],
    of_normals: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(V, P) share of the hemisphere that is covered, and (V, P, 3) that times the radiance.

    ``surfels`` (7, D): positions, normals and areas.
    """
    voxels = len(of_positions)
    hidden = np.zeros((voxels, PATCHES), np.float32)
    sent = np.zeros((voxels, PATCHES, 3), np.float32)
    sides = np.zeros((2 * PATCHES, 4), np.float32)
    shares, places = np.empty(len(colours), np.float32), np.empty(len(colours), np.int32)
    for voxel in range(voxels):
        _cover(surfels, of_positions[voxel], of_normals[voxel], shares, places)
        sides[:] = 0.0
        for surfel in range(len(colours)):
            share = shares[surfel]
            if share > 0.0:
                side = sides[places[surfel]]
                side[0] += share * colours[surfel, 0]
                side[1] += share * colours[surfel, 1]
                side[2] += share * colours[surfel, 2]
                side[3] += share
        for patch in range(PATCHES):
            front, back = sides[patch], sides[PATCHES + patch]
            beyond = max(back[3] - front[3], 0.0)
            hidden[voxel, patch] = front[3] + beyond
            of_back = BACK * beyond / max(back[3], 1e-9)
            for channel in range(3):
                sent[voxel, patch, channel] = front[channel] + of_back * back[channel]
    return hidden, sent


@vectorised
def _cover(
    surfels: NDArray[np.float32],
    position: NDArray[np.float32],
    normal: NDArray[np.float32],
    shares: NDArray[np.float32],
    places: NDArray[np.int32],
) -> None:
    """Fill in the share of a voxel's hemisphere that each surfel covers, and in which patch.

    Patches of surfels that face away come after those of the others. Without branches, as
    :func:`.octahedral_texel` has them, for vector instructions.
    """
    zero, half, one = np.float32(0.0), np.float32(0.5), np.float32(1.0)
    flattest, about = np.float32(FLATTEST * FLATTEST), np.float32(1.0 / (2.0 * math.pi))
    inverse_pi, edge, last = np.float32(1.0 / math.pi), np.float32(EDGE), np.int32(EDGE - 1)
    px, py, pz = position[0], position[1], position[2]
    nx, ny, nz = normal[0], normal[1], normal[2]
    for n in range(len(shares)):
        x, y, z = surfels[0, n] - px, surfels[1, n] - py, surfels[2, n] - pz
        above, square = x * nx + y * ny + z * nz, x * x + y * y + z * z
        is_above = (above > zero) & (above * above >= flattest * square)
        facing = -(x * surfels[3, n] + y * surfels[4, n] + z * surfels[5, n])
        # A surfel close by covers no more than half of all directions.
        across = square * (square + surfels[6, n] * about)
        share = surfels[6, n] * abs(facing) * above * inverse_pi / (across if is_above else one)
        shares[n] = share if is_above else zero
        length = abs(x) + abs(y) + abs(z)
        scale = one / (length if is_above else one)
        u, v = x * scale, y * scale
        folded_u = (one - abs(v)) * (one if u >= zero else -one)
        folded_v = (one - abs(u)) * (one if v >= zero else -one)
        u, v = (folded_u if z < zero else u), (folded_v if z < zero else v)
        column = min(np.int32((u + one) * half * edge), last)
        row = min(np.int32((v + one) * half * edge), last)
        side = np.int32(0) if facing > zero else np.int32(PATCHES)
        places[n] = side + row * np.int32(EDGE) + column
