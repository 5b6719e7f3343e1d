"""The voxel observation store: what each surface voxel looked like from each view.

An observation is an 8-bit colour and the id of its view: 5 bytes. Its direction is derived from the
view's camera centre. A voxel keeps at most K of them (``observation_replacement``), and the store
at most ``capacity`` voxels.

Eviction: when a new voxel finds no room, voxels that the present frame does not see go, lowest
``last_seen + OBSERVATION_WORTH * observations`` first. So what was seen long ago goes before what
was seen recently, and a voxel seen from many views outlasts one seen from few.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion import observation_rows
from reflest_core.fusion.key_index import BYTES_PER_ROW, KeyIndex, are_unique_keys
from reflest_core.fusion.observation_rows import ObservationRows
from reflest_core.fusion.work_sharing import share_out

BYTES_PER_OBSERVATION = 3 + 2
BYTES_PER_VOXEL = BYTES_PER_ROW + 8 + 12 + 12 + 8 + 1 + 2

OBSERVATION_WORTH = 4
"""Frames for which one more observation prolongs a voxel's stay."""

EVICTED_SHARE = 16
"""Room is made for this fraction (one sixteenth) of the capacity at a time."""


LEAST_SHARE = 4096
"""Fewer voxels than this are not worth waking another thread."""


class ObservationStore:
    """``count`` voxels in use, the first ones of ``rows``; see :class:`ObservationRows`."""

    def __init__(self, capacity: int, observations_per_voxel: int) -> None:
        """``capacity``: voxels. ``observations_per_voxel``: K <= 255."""
        self.capacity = capacity
        self.count = 0
        self._index = index = KeyIndex(capacity)
        self.rows = ObservationRows(
            index_keys=index.keys,
            index_rows=index.rows,
            keys=np.zeros(capacity, np.int64),
            positions=np.zeros((capacity, 3), np.float32),
            normals=np.zeros((capacity, 3), np.float32),
            last_seen=np.zeros(capacity, np.int64),
            counts=np.zeros(capacity, np.uint8),
            pairs=np.zeros((capacity, 2), np.uint8),
            colours=np.zeros((capacity, observations_per_voxel, 3), np.uint8),
            view_ids=np.zeros((capacity, observations_per_voxel), np.uint16),
        )

    @property
    def nbytes(self) -> int:
        """Bytes reserved, whether filled or not."""
        return sum(array.nbytes for array in self.rows)

    @property
    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """The arrays that make up the store, at full capacity."""
        fields = self.rows._asdict().items()
        return {name: array for name, array in fields if not name.startswith("index_")}

    def restore(self, count: int, view_count: int) -> None:
        """Take the first ``count`` rows of :attr:`arrays`, just filled, for the store."""
        rows = self.rows
        used = np.arange(rows.view_ids.shape[1]) < rows.counts[:count, None]
        if not are_unique_keys(rows.keys[:count]) or np.any(
            rows.counts[:count] > rows.view_ids.shape[1]
        ):
            raise ValueError("voxel keys repeat or counts pass the slots")
        if np.any(rows.view_ids[:count][used] >= view_count) or np.any(
            rows.pairs[:count] >= rows.view_ids.shape[1]
        ):
            raise ValueError("observations of no view")
        self.count = count
        self._index.fill(rows.keys[:count])

    @property
    def observation_count(self) -> int:
        """Observations kept."""
        return int(np.sum(self.rows.counts[: self.count], dtype=np.int64))

    @property
    def observed_count(self) -> int:
        """Voxels with observations."""
        return int(np.count_nonzero(self.rows.counts[: self.count]))

    def find(self, keys: NDArray[np.int64], threads: int = 1) -> NDArray[np.int64]:
        """The row of each voxel key, -1 where it is not stored."""
        parts = share_out(
            threads, len(keys), LEAST_SHARE, observation_rows.find_rows, self.rows, keys
        )
        return np.concatenate(parts)

    def refresh(
        self,
        selected: NDArray[np.int64],
        positions: NDArray[np.float32],
        normals: NDArray[np.float32],
        threads: int = 1,
    ) -> None:
        """Renew position and normal (S, 3) of the rows ``selected``; -1 is none."""
        share_out(
            threads, len(selected), LEAST_SHARE, observation_rows.refresh_rows, self.rows,
            selected, positions, normals,
        )  # fmt: skip

    def move(self, left: NDArray[np.int64], left_to: NDArray[np.int64]) -> None:
        """Hand the observations of voxels that left the surface on (``SurfaceUpdate``)."""
        self.count = observation_rows.move_keys(self.rows, self.count, left, left_to)

    def remove(self, keys: NDArray[np.int64]) -> None:
        """Forget the stored ones of these voxels."""
        self.count = observation_rows.remove_keys(self.rows, self.count, keys)

    def claim(
        self,
        keys: NDArray[np.int64],
        rows: NDArray[np.int64],
        positions: NDArray[np.float32],
        normals: NDArray[np.float32],
        frame_number: int,
    ) -> NDArray[np.int64]:
        """Return a row for each voxel that frame ``frame_number`` sees, making room if need be.

        ``keys``: (S,) without repeats. ``rows``: where they are (:meth:`find`). -1 where even
        eviction made no room. Rows stay valid until the next call that adds or removes voxels.
        """
        self.rows.last_seen[rows[rows >= 0]] = frame_number
        missing = np.flatnonzero(rows < 0)
        if len(missing) > self.capacity - self.count:
            self._make_room(len(missing), frame_number)
            rows = self.find(keys)
        missing = missing[: self.capacity - self.count]
        added = np.arange(self.count, self.count + len(missing))
        self.rows.last_seen[added] = frame_number
        self.count = observation_rows.append_rows(
            self.rows, self.count, keys[missing], positions[missing], normals[missing]
        )
        rows = rows.copy()
        rows[missing] = added
        return rows

    def unseen_from(
        self, selected: NDArray[np.int64], views: NDArray[np.int64]
    ) -> NDArray[np.bool_]:
        """(S,) True for the selected rows that have no observation from any of ``views``."""
        return observation_rows.rows_unseen_from(self.rows, selected, views)

    def observe(
        self,
        selected: NDArray[np.int64],
        colours: NDArray[np.uint8],
        view: int,
        view_centres: NDArray[np.float32],
    ) -> int:
        """Add an observation of ``view`` to each selected row; return how many were kept.

        ``selected``: (S,) rows. ``colours``: (S, 3) uint8. ``view_centres``: (W, 3), of all views.
        """
        return observation_rows.observe_rows(self.rows, selected, colours, view, view_centres)

    def drop_view(self, view: int) -> None:
        """Forget every observation of ``view``."""
        observation_rows.drop_view(self.rows, self.count, view)

    def _make_room(self, wanted: int, frame_number: int) -> None:
        last_seen = self.rows.last_seen[: self.count]
        unseen = np.flatnonzero(last_seen < frame_number)
        worth = last_seen[unseen] + OBSERVATION_WORTH * self.rows.counts[unseen].astype(np.int64)
        shortfall = wanted - (self.capacity - self.count)
        evicted = unseen[np.argsort(worth, kind="stable")]
        evicted = evicted[: max(shortfall, self.capacity // EVICTED_SHARE)]
        self.remove(self.rows.keys[evicted])
