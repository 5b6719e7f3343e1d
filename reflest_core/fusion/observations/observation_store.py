# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The voxel observation store: what each surface voxel looked like from each view.

An observation is an 8-bit colour and the id of its view: 5 bytes. Its direction is derived from the
view's camera centre. A voxel keeps at most K of them (``observation_replacement``), and the store a
fixed number of voxels and of chunks of observations; when either runs out, some voxels give way
(``eviction``). A voxel for whose next observation there is no chunk even then is full with what it
has: it still trades observations for others that spread better.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.observations import observation_queries, observation_rows
from reflest_core.fusion.observations.eviction import least_worthy
from reflest_core.fusion.observations.observation_chunks import CHUNK, ChunkPool
from reflest_core.fusion.observations.observation_rows import ObservationRows
from reflest_core.fusion.work_sharing import share_out
from reflest_core.surface.key_index import BYTES_PER_ROW, KeyIndex, are_unique_keys
from reflest_core.surface.reserved import reserved

BYTES_PER_VOXEL = BYTES_PER_ROW + 8 + 12 + 12 + 4 + 1 + 2 + 4
"""Without its observations, which take ``BYTES_PER_CHUNK`` for every ``CHUNK`` of them."""

EVICTED_SHARE = 16
"""Room is made for this fraction (one sixteenth) of the capacity at a time."""

LEAST_SHARE = 4096
"""Fewer voxels than this are not worth waking another thread."""


class ObservationStore:
    """The observations of voxels; ``count`` rows are in use, the first ones of ``rows``."""

    def __init__(self, capacity: int, chunks: int, observations_per_voxel: int) -> None:
        """Reserve memory.

        Args:
            capacity: Voxels.
            chunks: Chunks of observations.
            observations_per_voxel: K, at most so many of one voxel are kept.
        """
        self.capacity = capacity
        self.count = 0
        self.observations_per_voxel = observations_per_voxel
        self.pool = ChunkPool(chunks)
        self._index = index = KeyIndex(capacity)
        self.rows = ObservationRows(
            index_keys=index.keys,
            index_rows=index.rows,
            keys=reserved(capacity, np.int64),
            positions=reserved((capacity, 3), np.float32),
            normals=reserved((capacity, 3), np.float32),
            last_seen=reserved(capacity, np.int32),
            counts=reserved(capacity, np.uint8),
            pairs=reserved((capacity, 2), np.uint8),
            first_chunks=reserved(capacity, np.int32),
        )

    @property
    def nbytes(self) -> int:
        """Bytes reserved, whether filled or not."""
        return sum(array.nbytes for array in self.rows) + self.pool.nbytes

    @property
    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """The arrays that make up the rows, at full capacity."""
        fields = self.rows._asdict().items()
        return {name: array for name, array in fields if not name.startswith("index_")}

    def restore(self, count: int, chunk_count: int, is_view: NDArray[np.bool_]) -> None:
        """Take the first rows of :attr:`arrays` and of the pool's, just filled, for the store.

        Args:
            count: Rows that were filled.
            chunk_count: Chunks that were filled.
            is_view: (W,) whether observations may be of a view.

        Raises:
            ValueError: The rows contradict themselves.
        """
        rows = self.rows
        if not are_unique_keys(rows.keys[:count]):
            raise ValueError("voxel keys repeat")
        if np.any(rows.counts[:count] > self.observations_per_voxel) or np.any(
            rows.pairs[:count] >= self.observations_per_voxel
        ):
            raise ValueError("a voxel has too many observations")
        self.pool.restore(chunk_count, rows.first_chunks[:count], rows.counts[:count])
        self.count = count
        self._index.fill(rows.keys[:count])
        _, view_ids = self.observations(np.arange(count))
        if np.any(view_ids >= len(is_view)) or not is_view[view_ids].all():
            raise ValueError("observations of no view")

    @property
    def observation_count(self) -> int:
        """Observations kept."""
        return self.pool.observations

    @property
    def observed_count(self) -> int:
        """Voxels with observations."""
        return int(np.count_nonzero(self.rows.counts[: self.count]))

    def observations(
        self, selected: NDArray[np.int64], threads: int = 1
    ) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
        """Copy the observations of rows, one row after another.

        Args:
            selected: (S,) rows; ``rows.counts[selected]`` says how many observations belong to
                each.
            threads: Threads that share the work.

        Returns:
            (O, 3) 8-bit colours and (O,) view ids.
        """
        offsets = np.zeros(len(selected) + 1, np.int64)
        np.cumsum(self.rows.counts[selected], out=offsets[1:], dtype=np.int64)
        colours = np.empty((offsets[-1], 3), np.uint8)
        view_ids = np.empty(offsets[-1], np.uint16)
        share_out(
            threads,
            len(selected),
            LEAST_SHARE,
            observation_queries.gather_observations,
            self.rows,
            self.pool.chunks,
            selected,
            offsets,
            colours,
            view_ids,
        )
        return colours, view_ids

    def find(self, keys: NDArray[np.int64], threads: int = 1) -> NDArray[np.int64]:
        """Look voxels up.

        Args:
            keys: (N,) voxel keys.
            threads: Threads that share the work.

        Returns:
            (N,) rows, -1 where a voxel is not stored.
        """
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
        """Renew positions and normals of rows.

        Args:
            selected: (S,) rows, -1 for none.
            positions: (S, 3) world frame, metres.
            normals: (S, 3) unit.
            threads: Threads that share the work.
        """
        share_out(
            threads,
            len(selected),
            LEAST_SHARE,
            observation_rows.refresh_rows,
            self.rows,
            selected,
            positions,
            normals,
        )

    def move(self, left: NDArray[np.int64], left_to: NDArray[np.int64]) -> None:
        """Hand on the observations of voxels that left the surface (:class:`.SurfaceUpdate`).

        Args:
            left: (L,) voxels that left.
            left_to: (L,) voxels that their surface moved to, ``NO_KEY`` for none.
        """
        self.count = observation_rows.move_keys(
            self.rows, self.pool.chunks, self.count, left, left_to
        )

    def remove(self, keys: NDArray[np.int64]) -> None:
        """Forget voxels, stored or not.

        Args:
            keys: (N,) voxel keys.
        """
        self.count = observation_rows.remove_keys(self.rows, self.pool.chunks, self.count, keys)

    def claim(
        self,
        keys: NDArray[np.int64],
        rows: NDArray[np.int64],
        positions: NDArray[np.float32],
        normals: NDArray[np.float32],
        frame_number: int,
    ) -> NDArray[np.int64]:
        """Return a row for each voxel that a frame sees, making room if need be.

        Rows stay valid until the next call that adds or removes voxels.

        Args:
            keys: (S,) voxel keys without repeats.
            rows: (S,) where they are (:meth:`find`).
            positions: (S, 3) world frame, metres.
            normals: (S, 3) unit.
            frame_number: The frame.

        Returns:
            (S,) rows; -1 where even eviction made no room.
        """
        known = rows[rows >= 0]
        self.rows.last_seen[known] = frame_number
        missing = np.flatnonzero(rows < 0)
        counts = self.rows.counts[known]
        growing = int(np.sum((counts % CHUNK == 0) & (counts < self.observations_per_voxel)))
        if self._make_room(len(missing), len(missing) + growing, frame_number):
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
        self, selected: NDArray[np.int64], views: NDArray[np.int64], threads: int = 1
    ) -> NDArray[np.bool_]:
        """Find the rows that have no observation from any of some views.

        Args:
            selected: (S,) rows.
            views: View ids.
            threads: Threads that share the work.

        Returns:
            (S,) bool.
        """
        parts = share_out(
            threads,
            len(selected),
            LEAST_SHARE,
            observation_queries.rows_unseen_from,
            self.rows,
            self.pool.chunks,
            selected,
            marked(views),
        )
        return np.concatenate(parts)

    def observe(
        self,
        selected: NDArray[np.int64],
        colours: NDArray[np.uint8],
        view: int,
        view_centres: NDArray[np.float32],
        threads: int = 1,
    ) -> int:
        """Add an observation to each of some rows.

        Args:
            selected: (S,) rows, each once.
            colours: (S, 3) 8-bit sRGB.
            view: Id of the view that observes.
            view_centres: (W, 3) camera centres of all views, world frame, metres.
            threads: Threads that share the work on full rows, which is most of it.

        Returns:
            How many observations were kept.
        """
        is_full = self.rows.counts[selected] == self.observations_per_voxel
        kept = 0
        for part, sharing in ((~is_full, 1), (is_full, threads)):
            rows = selected[part]
            kept += sum(
                share_out(
                    sharing,
                    len(rows),
                    LEAST_SHARE,
                    observation_rows.observe_rows,
                    self.rows,
                    self.pool.chunks,
                    self.observations_per_voxel,
                    rows,
                    colours[part],
                    view,
                    view_centres,
                )
            )
        return kept

    def drop_views(self, views: NDArray[np.int64]) -> None:
        """Forget every observation of some views.

        Args:
            views: View ids.
        """
        observation_rows.drop_views(self.rows, self.pool.chunks, self.count, marked(views))

    def _make_room(self, rows: int, chunks: int, frame_number: int) -> bool:
        """Evict voxels if so many rows or chunks are not free; returns whether any went."""
        rows -= self.capacity - self.count
        chunks -= self.pool.capacity - self.pool.taken
        if rows <= 0 and chunks <= 0:
            return False
        evicted = least_worthy(
            self.rows.last_seen[: self.count],
            self.rows.counts[: self.count],
            frame_number,
            max(rows, self.capacity // EVICTED_SHARE) if rows > 0 else 0,
            max(chunks, self.pool.capacity // EVICTED_SHARE) if chunks > 0 else 0,
        )
        self.remove(self.rows.keys[evicted])
        return len(evicted) > 0


def marked(views: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Turn view ids into a table for kernels.

    Args:
        views: View ids.

    Returns:
        (65536,) bool, True at ``views``.
    """
    is_one = np.zeros(1 << 16, np.bool_)
    is_one[views] = True
    return is_one
