"""Grouplets: small random sets of observations of one voxel (section 3.3.2, Figure 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.observed_surface import ObservedSurface

BRANCHES = 5
"""M: observations in one node."""
NODES_PER_VOXEL = 10
BRANCH_INPUTS = 12
"""Colour, omega_o, F and B: three values each."""


@dataclass(frozen=True)
class Grouplets:
    """Inputs of G nodes.

    ``branches``: (G, 5, 12) float32, ``(C, omega_o, F, B)`` with colours / 255 and ``omega_o`` in
    the world frame, sorted by falling ``omega_o . n``. ``normals``: (G, 3) float32, world frame.
    """

    branches: NDArray[np.float32]
    normals: NDArray[np.float32]


def draw_grouplets(
    surface: ObservedSurface, voxels: NDArray[np.int64], seed: int, nodes: int = NODES_PER_VOXEL
) -> Grouplets:
    """Draw ``nodes`` grouplets from each of the ``voxels`` (N,), all of them observed.

    Observations are drawn without replacement where a voxel has five or more, else with. An
    unknown F or B (NaN) enters as 0. The same seed draws the same grouplets.
    """
    branches = np.empty((len(voxels) * nodes, BRANCHES, BRANCH_INPUTS), np.float32)
    normals = np.repeat(surface.normals[voxels], nodes, axis=0)
    _draw(
        surface.positions, surface.normals, surface.offsets, surface.colours,
        surface.view_indices, surface.view_centres,
        np.nan_to_num(surface.view_foreground) / np.float32(255),
        np.nan_to_num(surface.view_background) / np.float32(255),
        voxels, np.random.default_rng(seed).random((len(normals), BRANCHES)), nodes, branches,
    )  # fmt: skip
    return Grouplets(branches, normals)


@numba.njit(cache=True, nogil=True)
def _draw(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    offsets: NDArray[np.int64],
    colours: NDArray[np.uint8],
    view_indices: NDArray[np.uint16],
    view_centres: NDArray[np.float32],
    foreground: NDArray[np.float32],
    background: NDArray[np.float32],
    voxels: NDArray[np.int64],
    uniform: NDArray[np.float64],
    nodes: int,
    branches: NDArray[np.float32],
) -> None:
    chosen = np.empty(BRANCHES, np.int64)
    cosines = np.empty(BRANCHES)
    rows = np.empty((BRANCHES, BRANCH_INPUTS), np.float32)
    for group in range(len(branches)):
        voxel = voxels[group // nodes]
        first, count = offsets[voxel], offsets[voxel + 1] - offsets[voxel]
        for k in range(BRANCHES):
            chosen[k] = _draw_one(uniform[group, k], count, chosen[:k])
        for k in range(BRANCHES):
            index = first + chosen[k]
            view = view_indices[index]
            direction = view_centres[view] - positions[voxel]
            direction = direction / np.sqrt(np.sum(direction * direction))
            cosines[k] = np.sum(direction * normals[voxel])
            for channel in range(3):
                rows[k, channel] = colours[index, channel] / 255.0
                rows[k, 3 + channel] = direction[channel]
                rows[k, 6 + channel] = foreground[view, channel]
                rows[k, 9 + channel] = background[view, channel]
        order = np.argsort(-cosines, kind="mergesort")
        for k in range(BRANCHES):
            branches[group, k] = rows[order[k]]


@numba.njit(cache=True, nogil=True)
def _draw_one(uniform: float, count: int, taken: NDArray[np.int64]) -> int:
    """An index below ``count``, not among ``taken`` where ``count`` allows five distinct ones."""
    if count < BRANCHES:
        return int(uniform * count)
    index = int(uniform * (count - len(taken)))
    # The index-th of those left: step over the taken ones in rising order.
    for value in np.sort(taken):
        if index >= value:
            index += 1
    return index
