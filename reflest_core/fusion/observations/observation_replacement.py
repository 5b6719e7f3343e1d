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
    """Fill in unit vectors from a voxel to its views; a kernel.

    Args:
        position: (3,) of the voxel, world frame, metres.
        view_ids: (K,) its views.
        count: How many there are.
        view_centres: (W, 3) camera centres of all views, world frame, metres.
        directions: (3, K) filled.
    """
    for n in range(count):
        centre = view_centres[view_ids[n]]
        x = float(centre[0]) - float(position[0])
        y = float(centre[1]) - float(position[1])
        z = float(centre[2]) - float(position[2])
        length = np.sqrt(x * x + y * y + z * z)
        directions[0, n], directions[1, n], directions[2, n] = x / length, y / length, z / length


@compiled
def squared_chord(directions: NDArray[np.float64], m: int, n: int) -> float:
    """Return the squared distance between two unit directions; a kernel.

    Args:
        directions: (3, K) unit vectors.
        m: One of them.
        n: The other.

    Returns:
        A number in [0, 4].
    """
    x = directions[0, m] - directions[0, n]
    y = directions[1, m] - directions[1, n]
    z = directions[2, m] - directions[2, n]
    return float(x * x + y * y + z * z)


@compiled
def nearest_neighbour(
    directions: NDArray[np.float64], count: int, new: int, skip_a: int, skip_b: int
) -> float:
    """Return the squared chord from a direction to the nearest of the others; a kernel.

    Args:
        directions: (3, K) unit vectors.
        count: The first so many are the others.
        new: The direction.
        skip_a: One of the others that does not count, or -1.
        skip_b: The same.

    Returns:
        The squared chord, infinite where there is no other.
    """
    nearest = np.inf
    for n in range(count):
        if n != new and n != skip_a and n != skip_b:
            nearest = min(nearest, squared_chord(directions, new, n))
    return nearest


@compiled
def closest_pair(directions: NDArray[np.float64], count: int) -> tuple[int, int]:
    """Find the two directions that are closest together, lowest slots first; a kernel.

    Args:
        directions: (3, K) unit vectors.
        count: The first so many count.

    Returns:
        Both slots.
    """
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
    """Choose the slot that a new direction should take; a kernel.

    Args:
        directions: (3, K) unit vectors: the kept ones, then the new one.
        count: How many are kept.
        pair: The closest pair of the kept directions.

    Returns:
        The slot, or -1 to leave all as they are.
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
