# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Room for observations, handed out to voxels eight at a time.

A voxel's chunks are chained, the newest first. Its observation in slot ``s`` (they are numbered as
they come) is number ``s % 8`` of the chunk ``s // 8`` counted from the oldest. So a voxel seen from
few views takes little room, and one seen from many takes 5.5 bytes for each observation.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.reserved import reserved

CHUNK = 8
"""Observations of a chunk."""

BYTES_PER_CHUNK = CHUNK * (3 + 2) + 4

NONE = -1

_FREE, _COUNT, _TAKEN = 0, 1, 2

OBSERVATIONS = 3
"""Where in ``state`` the observations are counted."""


class ObservationChunks(NamedTuple):
    """C chunks, as kernels take them.

    Attributes:
        colours: (C, 8, 3) uint8, 8-bit sRGB.
        view_ids: (C, 8) uint16.
        after: (C,) int32, the next older chunk of the voxel or the next free one, ``NONE`` at the
            end.
        state: (4,) int64: the first free chunk, how many chunks were ever taken, how many are taken
            now, and how many observations they hold.
    """

    colours: NDArray[np.uint8]
    view_ids: NDArray[np.uint16]
    after: NDArray[np.int32]
    state: NDArray[np.int64]


class ChunkPool:
    """A fixed number of chunks, of which the first ``count`` were taken at some time."""

    def __init__(self, capacity: int) -> None:
        """Reserve the chunks.

        Args:
            capacity: Chunks.
        """
        self.capacity = capacity
        self.chunks = ObservationChunks(
            colours=reserved((capacity, CHUNK, 3), np.uint8),
            view_ids=reserved((capacity, CHUNK), np.uint16),
            after=reserved(capacity, np.int32),
            state=np.array([NONE, 0, 0, 0], np.int64),
        )

    @property
    def count(self) -> int:
        """Chunks that were ever taken; the others have never been touched."""
        return int(self.chunks.state[_COUNT])

    @property
    def taken(self) -> int:
        """Chunks that voxels hold now."""
        return int(self.chunks.state[_TAKEN])

    @property
    def observations(self) -> int:
        """Observations that voxels have."""
        return int(self.chunks.state[OBSERVATIONS])

    @property
    def nbytes(self) -> int:
        """Bytes reserved, whether filled or not."""
        return sum(array.nbytes for array in self.chunks)

    @property
    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """The arrays that make up the pool, at full capacity."""
        return {name: getattr(self.chunks, name) for name in ("colours", "view_ids", "after")}

    def restore(
        self, count: int, first_chunks: NDArray[np.int32], counts: NDArray[np.uint8]
    ) -> None:
        """Take the first chunks of :attr:`arrays`, just filled, for the pool.

        Args:
            count: How many chunks were filled.
            first_chunks: (R,) newest chunk of every voxel.
            counts: (R,) observations of every voxel.

        Raises:
            ValueError: A chain is broken.
        """
        if not _sort_out(self.chunks, count, first_chunks, counts):
            raise ValueError("a voxel's observations are not its own")


@compiled
def take_chunk(chunks: ObservationChunks, after: int) -> int:
    """Take a free chunk and chain it before another; a kernel.

    Args:
        chunks: The pool's arrays.
        after: The next older chunk of the voxel, or ``NONE``.

    Returns:
        The chunk, or ``NONE`` if all are taken.
    """
    chunk = int(chunks.state[_FREE])
    if chunk != NONE:
        chunks.state[_FREE] = chunks.after[chunk]
    elif chunks.state[_COUNT] < len(chunks.after):
        chunk = int(chunks.state[_COUNT])
        chunks.state[_COUNT] += 1
    else:
        return NONE
    chunks.state[_TAKEN] += 1
    chunks.after[chunk] = after
    return chunk


@compiled
def release_chunk(chunks: ObservationChunks, chunk: int) -> int:
    """Give a chunk back; a kernel.

    Args:
        chunks: The pool's arrays.
        chunk: The chunk.

    Returns:
        The chunk after it in its voxel's chain.
    """
    after = int(chunks.after[chunk])
    chunks.after[chunk] = chunks.state[_FREE]
    chunks.state[_FREE] = chunk
    chunks.state[_TAKEN] -= 1
    return after


@compiled
def chunk_of_slot(chunks: ObservationChunks, first: int, count: int, slot: int) -> int:
    """Find the chunk that holds a slot; a kernel.

    Args:
        chunks: The pool's arrays.
        first: Newest chunk of the voxel.
        count: Observations of the voxel.
        slot: One of them.

    Returns:
        The chunk.
    """
    chunk = first
    for _ in range((count - 1) // CHUNK - slot // CHUNK):
        chunk = int(chunks.after[chunk])
    return chunk


@compiled
def copy_observations(
    chunks: ObservationChunks,
    first: int,
    count: int,
    colours: NDArray[np.uint8],
    view_ids: NDArray[np.uint16],
) -> None:
    """Copy a voxel's observations in the order of their slots; a kernel.

    Args:
        chunks: The pool's arrays.
        first: Newest chunk of the voxel.
        count: Observations of the voxel.
        colours: (K, 3) filled.
        view_ids: (K,) filled.
    """
    chunk, last = first, count
    while last > 0:
        start = (last - 1) // CHUNK * CHUNK
        for slot in range(last - start):  # assigning slices takes more than twice as long
            for channel in range(3):
                colours[start + slot, channel] = chunks.colours[chunk, slot, channel]
            view_ids[start + slot] = chunks.view_ids[chunk, slot]
        chunk, last = int(chunks.after[chunk]), start


@compiled
def _sort_out(
    chunks: ObservationChunks,
    count: int,
    first_chunks: NDArray[np.int32],
    counts: NDArray[np.uint8],
) -> bool:
    """Follow every voxel's chain and chain up the rest; False if a chain is broken."""
    is_taken = np.zeros(count, np.bool_)
    chunks.state[_COUNT] = count
    chunks.state[_TAKEN] = 0
    chunks.state[OBSERVATIONS] = 0
    for row in range(len(first_chunks)):
        chunk = int(first_chunks[row])
        chunks.state[OBSERVATIONS] += counts[row]
        for _ in range((int(counts[row]) + CHUNK - 1) // CHUNK):
            if not (0 <= chunk < count) or is_taken[chunk]:
                return False
            is_taken[chunk] = True
            chunks.state[_TAKEN] += 1
            chunk = int(chunks.after[chunk])
        if chunk != NONE:
            return False
    chunks.state[_FREE] = NONE
    for chunk in range(count):
        if not is_taken[chunk]:
            chunks.after[chunk] = chunks.state[_FREE]
            chunks.state[_FREE] = chunk
    return True
