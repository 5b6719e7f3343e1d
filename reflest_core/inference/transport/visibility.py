# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How much of each patch of light an object hides from its own surface.

Voxels are taken for surfels, and what they cover of each other's view is summed by patch (Bunnell
2005, "Dynamic Ambient Occlusion and Indirect Lighting"): no rays, and a part that was never scanned
hides nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.transport.patch_grid import EDGE, PATCHES, patch_shares
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.octahedral import octahedral_texel
from reflest_core.surface.extent import NEIGHBOURS, surfel_areas

LEAST_SHARE = 1e-3
"""Of the hemisphere, weighted by cosine: patches that show less of it are not hidden further."""
FLATTEST = 0.05
"""Cosine between a normal and the direction to another voxel: below it they are one surface."""


@dataclass(frozen=True)
class Sight:
    """What R voxels, or observations of voxels, see of the light past the rest of the scan.

    Attributes:
        visible: (R, P) float32 in [0, 1], the share of each patch's light that arrives.
        own: the mean linear radiance that the scan sends from where it hides the light: (3,)
            float32 of all, or (R, P, 3) of each patch, 0 where it hides nothing.
        selected: (N,) indices of the R rows that are meant; None for all in their order.
    """

    visible: NDArray[np.float32]
    own: NDArray[np.float32]
    selected: NDArray[np.int64] | None = None

    @staticmethod
    def open(count: int) -> Sight:
        """Return the sight of voxels that nothing hides light from.

        Args:
            count: voxels.
        """
        return Sight(np.ones((count, PATCHES), np.float32), np.zeros(3, np.float32))

    def of(self, rows: NDArray[np.int64]) -> Sight:
        """Select rows, without a copy.

        Args:
            rows: (N,) indices of voxels or observations.
        """
        return replace(self, selected=self.rows[rows])

    @property
    def rows(self) -> NDArray[np.int64]:
        """(N,) indices of the rows that are meant."""
        return np.arange(len(self.visible)) if self.selected is None else self.selected

    @property
    def is_coloured(self) -> bool:
        """Whether what hides each patch has a colour of its own."""
        return self.own.ndim == 3


@dataclass(frozen=True)
class Occluders:
    """Surfels that stand for a surface.

    Attributes:
        positions: (D, 3) metres.
        normals: (D, 3) unit.
        areas: (D,) square metres.
        own: (3,) their mean linear radiance.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    areas: NDArray[np.float32]
    own: NDArray[np.float32]

    @staticmethod
    def of(
        positions: NDArray[np.float32], normals: NDArray[np.float32], own: NDArray[np.float32]
    ) -> Occluders:
        """Make surfels of voxels; with very few of them nothing is hidden.

        Args:
            positions: (D, 3), metres, spread over the surface.
            normals: (D, 3) unit.
            own: (3,) mean linear radiance of the surface.
        """
        if len(positions) <= NEIGHBOURS:
            return Occluders(positions[:0], normals[:0], np.zeros(0, np.float32), own)
        return Occluders(positions, normals, surfel_areas(positions), own)

    def sight(
        self,
        positions: NDArray[np.float32],
        normals: NDArray[np.float32],
        weights: NDArray[np.float32],
    ) -> Sight:
        """Compute what voxels see of the light.

        Args:
            positions: (V, 3), metres.
            normals: (V, 3) unit.
            weights: (V, SIZE * SIZE) of :func:`.cosine_weights`.
        """
        hidden = _hidden_shares(
            kernel_array(self.positions, np.float32),
            kernel_array(self.normals, np.float32),
            kernel_array(self.areas, np.float32),
            kernel_array(positions, np.float32),
            kernel_array(normals, np.float32),
            EDGE,
        )
        whole = patch_shares(weights)
        shares = np.minimum(hidden / np.maximum(whole, LEAST_SHARE), 1.0)
        return Sight(np.asarray(1.0 - shares, np.float32), self.own)


@compiled
def _hidden_shares(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    areas: NDArray[np.float32],
    of_positions: NDArray[np.float32],
    of_normals: NDArray[np.float32],
    edge: int,
) -> NDArray[np.float32]:
    """(V, edge * edge): of the whole hemisphere, weighted by cosine, what discs cover by patch."""
    hidden = np.zeros((len(of_positions), edge * edge), np.float32)
    for voxel in range(len(of_positions)):
        for disc in range(len(positions)):
            x = positions[disc, 0] - of_positions[voxel, 0]
            y = positions[disc, 1] - of_positions[voxel, 1]
            z = positions[disc, 2] - of_positions[voxel, 2]
            square = x * x + y * y + z * z
            above = x * of_normals[voxel, 0] + y * of_normals[voxel, 1] + z * of_normals[voxel, 2]
            facing = -(x * normals[disc, 0] + y * normals[disc, 1] + z * normals[disc, 2])
            if square == 0.0 or above <= 0.0 or facing <= 0.0:
                continue
            distance = math.sqrt(square)
            if above < FLATTEST * distance:
                continue
            row, column = octahedral_texel(x, y, z, edge)
            # A disc close by covers no more than half of all directions.
            angle = areas[disc] * facing / distance / (square + areas[disc] / (2.0 * math.pi))
            hidden[voxel, row * edge + column] += angle * above / distance / math.pi
    return hidden
