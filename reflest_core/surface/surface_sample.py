# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The observations that an estimate rests on: some voxels, and some views of each."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.surface.observed_surface import ObservedSurface

OBSERVATIONS = 12
"""Of one voxel at most; more are thinned evenly over the order in which they were made."""


@dataclass(frozen=True)
class SurfaceSample:
    """V voxels and O of their observations, grouped by voxel.

    Attributes:
        voxels: (V,) indices into the surface.
        normals: (V, 3) unit.
        voxel_of: (O,) each observation's place among the voxels.
        slot: (O,) each observation's place among those of its voxel.
        directions: (O, 3) ``omega_o``, unit.
        colours: (O, 3) linear.
        clipped: (O, 3) bool, channels at 255.
    """

    voxels: NDArray[np.int64]
    normals: NDArray[np.float32]
    voxel_of: NDArray[np.int64]
    slot: NDArray[np.int64]
    directions: NDArray[np.float32]
    colours: NDArray[np.float32]
    clipped: NDArray[np.bool_]

    def every(self, step: int) -> SurfaceSample:
        """Thin the observations.

        Args:
            step: The first of every ``step`` observations is kept.

        Returns:
            The same voxels with fewer observations.
        """
        kept = slice(None, None, step)
        return dataclasses.replace(
            self,
            voxel_of=self.voxel_of[kept],
            slot=self.slot[kept],
            directions=self.directions[kept],
            colours=self.colours[kept],
            clipped=self.clipped[kept],
        )

    def spread(self, values: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
        """Lay values of observations out by voxel.

        Args:
            values: (O, ...) a value of each observation.

        Returns:
            (V, 12, ...) the values; zeros where there is no observation.
        """
        grid = np.zeros((len(self.voxels), OBSERVATIONS, *values.shape[1:]), np.float32)
        grid[self.voxel_of, self.slot] = values
        return grid


def sampled(surface: ObservedSurface, voxels: NDArray[np.int64]) -> SurfaceSample:
    """Take at most 12 observations of each voxel.

    Args:
        surface: What was observed.
        voxels: (V,) indices into it.

    Returns:
        The sample.
    """
    rows, voxel_of, slot = _chosen(surface, voxels)
    directions = surface.directions_of(rows, voxels[voxel_of])
    colours = surface.colours[rows]
    return SurfaceSample(
        voxels,
        surface.normals[voxels],
        voxel_of,
        slot,
        directions,
        srgb.LINEAR[colours],
        colours == 255,
    )


def _chosen(
    surface: ObservedSurface, voxels: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Rows of the chosen observations, each one's place in ``voxels``, and its slot there."""
    first, counts = surface.offsets[voxels], surface.observation_counts[voxels]
    taken = np.minimum(counts, OBSERVATIONS)
    voxel_of = np.repeat(np.arange(len(voxels)), taken)
    slot = np.arange(len(voxel_of)) - np.repeat(np.cumsum(taken) - taken, taken)
    step = slot * counts[voxel_of] // np.maximum(taken[voxel_of], 1)
    return first[voxel_of] + step, voxel_of, slot
