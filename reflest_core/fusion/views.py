"""The stored views: where each camera was, and its F and B."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

VIEW_CAPACITY = 4096
"""Views kept; the oldest gives way with its observations when a new one comes."""

BYTES_PER_VIEW = 3 * 12 + 8 + 8


class ViewTable:
    """The first ``count`` rows hold a view each; a row number is an observation's view id.

    ``centres``: (W, 3) float32, camera centres in the world frame, metres. ``foreground``,
    ``background``: (W, 3) float32, F and B, mean 8-bit colour, NaN where unknown. ``stamps``: (W,)
    int64, nanoseconds. ``order``: (W,) int64, rising in the order of storing.
    """

    def __init__(self, capacity: int = VIEW_CAPACITY) -> None:
        self.capacity = capacity
        self.count = 0
        self.centres: NDArray[np.float32] = np.zeros((capacity, 3), np.float32)
        self.foreground: NDArray[np.float32] = np.zeros((capacity, 3), np.float32)
        self.background: NDArray[np.float32] = np.zeros((capacity, 3), np.float32)
        self.stamps: NDArray[np.int64] = np.zeros(capacity, np.int64)
        self.order: NDArray[np.int64] = np.zeros(capacity, np.int64)

    @property
    def nbytes(self) -> int:
        """Bytes reserved, whether filled or not."""
        return sum(array.nbytes for array in self.arrays.values())

    @property
    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """The arrays that make up the table, at full capacity."""
        names = ("centres", "foreground", "background", "stamps", "order")
        return {name: getattr(self, name) for name in names}

    def near(
        self, centre: NDArray[np.float64], scene: NDArray[np.float64], spacing: float
    ) -> NDArray[np.int64]:
        """Ids of the views from which ``scene`` looks as it does from ``centre``, nearest first.

        Those are the views closer to ``centre`` than ``spacing`` (degrees) spans at the distance
        from ``scene`` to ``centre``; both (3,), world frame, metres.
        """
        distance = float(np.linalg.norm(centre - scene))
        reach = 2.0 * math.sin(math.radians(spacing) / 2.0) * distance
        away = np.linalg.norm(self.centres[: self.count] - centre, axis=1)
        ids = np.flatnonzero(away < reach)
        return ids[np.argsort(away[ids], kind="stable")]

    def oldest(self) -> int:
        """The id of the view stored first."""
        return int(np.argmin(self.order[: self.count]))

    def put(
        self,
        centre: NDArray[np.float64],
        foreground: NDArray[np.float32],
        background: NDArray[np.float32],
        stamp_ns: int,
    ) -> int:
        """Store a view and return its id; a full table gives it the oldest view's.

        The caller must have dropped the oldest view's observations before.
        """
        newest = int(np.max(self.order[: self.count], initial=-1))
        view = self.oldest() if self.is_full else self.count
        self.count = max(self.count, view + 1)
        self.centres[view] = centre
        self.foreground[view] = foreground
        self.background[view] = background
        self.stamps[view] = stamp_ns
        self.order[view] = newest + 1
        return view

    @property
    def is_full(self) -> bool:
        """Whether the next view takes the oldest one's place."""
        return self.count == self.capacity
