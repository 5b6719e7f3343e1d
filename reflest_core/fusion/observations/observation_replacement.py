# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which observations a full voxel keeps: those that spread over the directions of view.

A new observation replaces one of the two whose directions are closest together, if it is farther
from its own nearest neighbour than those two are from each other; of the two, the one whose next
neighbour is nearer goes. The smallest angle between any two kept directions thus never shrinks.
Distances are squared chords between unit directions, which order as angles do.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled


@compiled
def directions_to_views(
    position: NDArray[np.float32],
    view_ids: NDArray[np.uint16],
    count: int,
    view_centres: NDArray[np.float32],
    directions: NDArray[np.float64],
) -> None:
    """Fill ``directions`` (3, K) with unit vectors from the voxel to its ``count`` views."""
    for n in range(count):
        centre = view_centres[view_ids[n]]
        x = float(centre[0]) - float(position[0])
        y = float(centre[1]) - float(position[1])
        z = float(centre[2]) - float(position[2])
        length = np.sqrt(x * x + y * y + z * z)
        directions[0, n], directions[1, n], directions[2, n] = x / length, y / length, z / length


@compiled
def squared_chord(directions: NDArray[np.float64], m: int, n: int) -> float:
    """Squared distance between two unit directions, in [0, 4]."""
    x = directions[0, m] - directions[0, n]
    y = directions[1, m] - directions[1, n]
    z = directions[2, m] - directions[2, n]
    return float(x * x + y * y + z * z)


@compiled
def nearest_neighbour(
    directions: NDArray[np.float64], count: int, new: int, skip_a: int, skip_b: int
) -> float:
    """Squared chord from ``new`` to the nearest of the first ``count`` but the skipped."""
    nearest = np.inf
    for n in range(count):
        if n != new and n != skip_a and n != skip_b:
            nearest = min(nearest, squared_chord(directions, new, n))
    return nearest


@compiled
def closest_pair(directions: NDArray[np.float64], count: int) -> tuple[int, int]:
    """The two of the first ``count`` directions that are closest together, lowest slots first."""
    best_m, best_n, best = 0, 1, np.inf
    for m in range(count):
        row_best = np.inf
        for n in range(m + 1, count):
            row_best = min(row_best, squared_chord(directions, m, n))
        if row_best < best:
            best = row_best
            for n in range(m + 1, count):
                if squared_chord(directions, m, n) == best:
                    best_m, best_n = m, n
                    break
    return best_m, best_n


@compiled
def slot_to_replace(directions: NDArray[np.float64], count: int, pair: tuple[int, int]) -> int:
    """The slot that the direction in column ``count`` should take, or -1 to leave all as they are.

    ``pair``: the closest pair of the ``count`` kept directions.
    """
    a, b = pair
    spread = squared_chord(directions, a, b)
    if nearest_neighbour(directions, count, count, -1, -1) <= spread:
        return -1
    if nearest_neighbour(directions, count, a, b, -1) < nearest_neighbour(
        directions, count, b, a, -1
    ):
        return a
    return b
