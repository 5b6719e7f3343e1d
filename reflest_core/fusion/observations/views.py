# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The stored views: where each camera was, and its F and B."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, kernel_array

VIEW_CAPACITY = 4096
"""Views kept; when another comes, the oldest give way with their observations."""

FORGOTTEN_SHARE = 8
"""The oldest eighth gives way at a time, because the whole store is searched for it."""

_FREE = -1

BYTES_PER_VIEW = 3 * 12 + 8 + 8 + 4 + 4


class ViewTable:
    """The stored views; the first ``count`` rows hold one each, and a row number is a view id.

    Attributes:
        capacity: Most views.
        count: Rows in use.
        centres: (W, 3) float32, camera centres, world frame, metres.
        foreground: (W, 3) float32, F, mean 8-bit colour, NaN where unknown.
        background: (W, 3) float32, B, the same.
        stamps: (W,) int64, nanoseconds.
        order: (W,) int64, rising in the order of storing; -1 where no view is any more.
        frames: (W,) int32, frames fused of which it was the nearest view.
        gains: (W,) float32, factors that bring its linear colours to the scan's common exposure.
    """

    def __init__(self, capacity: int = VIEW_CAPACITY) -> None:
        """Reserve memory.

        Args:
            capacity: Most views.
        """
        self.capacity = capacity
        self.count = 0
        self.centres: NDArray[np.float32] = np.zeros((capacity, 3), np.float32)
        self.foreground: NDArray[np.float32] = np.zeros((capacity, 3), np.float32)
        self.background: NDArray[np.float32] = np.zeros((capacity, 3), np.float32)
        self.stamps: NDArray[np.int64] = np.zeros(capacity, np.int64)
        self.order: NDArray[np.int64] = np.zeros(capacity, np.int64)
        self.frames: NDArray[np.int32] = np.zeros(capacity, np.int32)
        self.gains: NDArray[np.float32] = np.ones(capacity, np.float32)

    @property
    def nbytes(self) -> int:
        """Bytes reserved, whether filled or not."""
        return sum(array.nbytes for array in self.arrays.values())

    @property
    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """The arrays that make up the table, at full capacity."""
        names = ("centres", "foreground", "background", "stamps", "order", "frames", "gains")
        return {name: getattr(self, name) for name in names}

    def near(
        self, centre: NDArray[np.float64], scene: NDArray[np.float64], spacing: float
    ) -> NDArray[np.int64]:
        """Find the views from which a scene looks as it does from a place.

        Those are the views closer to ``centre`` than ``spacing`` spans at the distance from
        ``scene`` to ``centre``.

        Args:
            centre: (3,) the place, world frame, metres.
            scene: (3,) the scene's middle, world frame, metres.
            spacing: Degrees.

        Returns:
            View ids, nearest first.
        """
        distance = float(np.linalg.norm(centre - scene))
        reach = 2.0 * math.sin(math.radians(spacing) / 2.0) * distance
        return _nearer_than(reach, self.centres[: self.count], kernel_array(centre, np.float64))

    def oldest(self) -> NDArray[np.int64]:
        """Choose the views that give way next.

        Returns:
            View ids: the oldest eighth.
        """
        stored = np.flatnonzero(self.order[: self.count] != _FREE)
        by_age = stored[np.argsort(self.order[stored], kind="stable")]
        return by_age[: max(1, self.capacity // FORGOTTEN_SHARE)]

    def forget(self, views: NDArray[np.int64]) -> None:
        """Free views; their observations must have been dropped before.

        Args:
            views: View ids.
        """
        self.order[views] = _FREE
        self.centres[views] = np.nan
        self.foreground[views] = np.nan
        self.background[views] = np.nan

    def put(
        self,
        centre: NDArray[np.float64],
        foreground: NDArray[np.float32],
        background: NDArray[np.float32],
        stamp_ns: int,
        gain: float = 1.0,
    ) -> int:
        """Store a view; the table must not be full.

        Args:
            centre: (3,) camera centre, world frame, metres.
            foreground: (3,) F, mean 8-bit colour, NaN where unknown.
            background: (3,) B, the same.
            stamp_ns: Nanoseconds.
            gain: Factor that brings its linear colours to the common exposure.

        Returns:
            The view's id.
        """
        used = self.order[: self.count]
        newest = int(np.max(used, initial=_FREE))
        free = np.flatnonzero(used == _FREE)
        view = int(free[0]) if len(free) else self.count
        self.count = max(self.count, view + 1)
        self.centres[view] = centre
        self.foreground[view] = foreground
        self.background[view] = background
        self.stamps[view] = stamp_ns
        self.order[view] = newest + 1
        self.frames[view] = 0
        self.gains[view] = gain
        return view

    @property
    def stored(self) -> int:
        """Views in the table."""
        return int(np.count_nonzero(self.order[: self.count] != _FREE))

    @property
    def is_full(self) -> bool:
        """Whether the oldest views must give way to another."""
        return self.stored == self.capacity


@compiled
def _nearer_than(
    reach: float, centres: NDArray[np.float32], place: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Rows of ``centres`` (N, 3) nearer to a place than ``reach``, nearest first."""
    rows, distances = np.empty(len(centres), np.int64), np.empty(len(centres))
    count = 0
    for row in range(len(centres)):
        squared = 0.0
        for axis in range(3):
            squared += (centres[row, axis] - place[axis]) ** 2
        distance = math.sqrt(squared)
        if not distance < reach:  # nor a forgotten view's NaN
            continue
        at = count
        while at > 0 and distances[at - 1] > distance:
            rows[at], distances[at] = rows[at - 1], distances[at - 1]
            at -= 1
        rows[at], distances[at] = row, distance
        count += 1
    return rows[:count].copy()
