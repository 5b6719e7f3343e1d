# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Grouplets: small random sets of observations of one voxel (section 3.3.2, Figure 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.observed_surface import ObservedSurface

BRANCHES = 5
"""M: observations in one node."""
NODES_PER_VOXEL = 10
DRAWN_FROM = 20
"""Random observations of a voxel, from which its nodes draw; shared ones are computed once."""
SEED = 0
"""Of an estimate's grouplets: drawn at random but always alike, so that estimates repeat."""
BRANCH_INPUTS = 12
"""Colour, omega_o, F and B: three values each."""


@dataclass(frozen=True)
class Grouplets:
    """Inputs of G nodes, which share D distinct observations.

    Attributes:
        observations: (D, 12) float32, ``(C, omega_o, F, B)`` with colours / 255 and ``omega_o`` in
            the world frame; those of one voxel stand together, voxels in the order of the nodes.
        members: (G, 5) int32 rows of ``observations``, by falling ``omega_o . n``.
        normals: (G, 3) float32, world frame.
    """

    observations: NDArray[np.float32]
    members: NDArray[np.int32]
    normals: NDArray[np.float32]

    @property
    def branches(self) -> NDArray[np.float32]:
        """(G, 5, 12) float32: the observations of every node."""
        return self.observations[self.members]


def draw_grouplets(
    surface: ObservedSurface, voxels: NDArray[np.int64], seed: int, nodes: int = NODES_PER_VOXEL
) -> Grouplets:
    """Draw grouplets from observed voxels.

    Observations are drawn without replacement where a voxel has five or more, else with, from at
    most :data:`DRAWN_FROM`. An unknown F or B (NaN) enters as 0.

    Args:
        surface: A scan, or a material's part of one, upright (+z is up).
        voxels: (N,) indices of voxels, all observed.
        seed: The same seed draws the same.
        nodes: Grouplets of each voxel.
    """
    rng = np.random.default_rng(seed)
    of_nodes = rng.random((len(voxels) * nodes, BRANCHES))
    of_voxels = rng.random((len(voxels), DRAWN_FROM))
    most = int(np.minimum(surface.observation_counts[voxels], DRAWN_FROM).sum())
    observations = np.empty((most, BRANCH_INPUTS), np.float32)
    members = np.empty((len(of_nodes), BRANCHES), np.int32)
    distinct = _draw(
        surface.positions,
        surface.normals,
        surface.offsets,
        surface.colours,
        surface.view_indices,
        surface.view_centres,
        np.nan_to_num(surface.view_foreground) / np.float32(255),
        np.nan_to_num(surface.view_background) / np.float32(255),
        voxels,
        of_nodes,
        of_voxels,
        nodes,
        observations,
        members,
    )
    normals = np.repeat(surface.normals[voxels], nodes, axis=0)
    return Grouplets(observations[:distinct], members, normals)


@compiled
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
    of_nodes: NDArray[np.float64],
    of_voxels: NDArray[np.float64],
    nodes: int,
    observations: NDArray[np.float32],
    members: NDArray[np.int32],
) -> int:
    """Fill ``members`` and the first rows of ``observations``; return how many of these."""
    distinct = 0
    cosines = np.empty(len(observations))
    for n in range(len(voxels)):
        voxel = voxels[n]
        first, count = offsets[voxel], offsets[voxel + 1] - offsets[voxel]
        drawn = members[n * nodes : (n + 1) * nodes]
        slots = shuffled_slots(of_voxels[n], count)
        row_of = np.full(count, -1, np.int32)
        for node in range(nodes):
            draw_without_repeats(of_nodes[n * nodes + node], len(slots), drawn[node])
            for k in range(BRANCHES):
                drawn[node, k] = slots[drawn[node, k]]
                row_of[drawn[node, k]] = 0
        for slot in range(count):
            if row_of[slot] < 0:
                continue
            row_of[slot] = distinct
            row = observations[distinct]
            view = view_indices[first + slot]
            squared = np.float32(0.0)
            for axis in range(3):
                row[3 + axis] = view_centres[view, axis] - positions[voxel, axis]
                squared += row[3 + axis] * row[3 + axis]
            if squared == 0.0:  # a camera on the voxel looks along the normal
                row[3:6], squared = normals[voxel], np.float32(1.0)
            cosine = 0.0
            for axis in range(3):
                row[axis] = colours[first + slot, axis] / 255.0
                row[3 + axis] /= np.sqrt(squared)
                row[6 + axis] = foreground[view, axis]
                row[9 + axis] = background[view, axis]
                cosine += row[3 + axis] * normals[voxel, axis]
            cosines[distinct] = cosine
            distinct += 1
        for node in range(nodes):
            for k in range(BRANCHES):
                drawn[node, k] = row_of[drawn[node, k]]
            _sort_by_falling(cosines, drawn[node])
    return distinct


@compiled
def shuffled_slots(uniform: NDArray[np.float64], count: int) -> NDArray[np.int32]:
    """Draw some of the numbers below ``count``, or all if they are few enough.

    Where some are left out, the first steps of a Fisher-Yates shuffle choose.

    Args:
        uniform: Numbers in [0, 1) that decide; as many as are drawn at most.
        count: How many there are to draw from.
    """
    slots = np.arange(count).astype(np.int32)
    if count <= len(uniform):
        return slots
    for place in range(len(uniform)):
        other = place + int(uniform[place] * (count - place))
        slots[place], slots[other] = slots[other], slots[place]
    return slots[: len(uniform)]


@compiled
def draw_without_repeats(
    uniform: NDArray[np.float64], count: int, drawn: NDArray[np.int32]
) -> None:
    """Draw indices below ``count``, distinct ones where there are five.

    Args:
        uniform: (5,) in [0, 1), which decides.
        count: How many there are to draw from.
        drawn: (5,), is filled.
    """
    taken = np.empty(BRANCHES, np.int64)  # rising
    for k in range(BRANCHES):
        if count < BRANCHES:
            drawn[k] = int(uniform[k] * count)
            continue
        index = int(uniform[k] * (count - k))
        # The index-th of those left: step over the taken ones in rising order.
        place = 0
        while place < k and taken[place] <= index:
            index += 1
            place += 1
        for later in range(k, place, -1):
            taken[later] = taken[later - 1]
        taken[place] = index
        drawn[k] = index


@compiled
def _sort_by_falling(keys: NDArray[np.float64], rows: NDArray[np.int32]) -> None:
    """Sort ``rows`` (a few) by falling ``keys[row]``; equal ones keep their order."""
    for k in range(1, len(rows)):
        row = rows[k]
        place = k
        while place > 0 and keys[rows[place - 1]] < keys[row]:
            rows[place] = rows[place - 1]
            place -= 1
        rows[place] = row
