# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A hash index from voxel or block keys to rows: open addressing with linear probing.

Half of its slots stay empty. Lookups do not depend on the order of insertion, removal shifts the
following entries back (Knuth, The Art of Computer Programming vol. 3, 6.4, algorithm R), so there
are no tombstones and no rehashing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.voxel_key import COORDINATE_BITS, NO_KEY

BYTES_PER_ROW = 48
"""Upper bound on the index's bytes for each row of capacity (12 bytes a slot, at most 4 slots)."""

_CELL = ~(1 << (2 * COORDINATE_BITS) | 1 << COORDINATE_BITS | 1)
"""The 2 x 2 x 2 keys that differ in the lowest bit of each coordinate have neighbouring slots, for
neighbours are looked up together and 8 keys are one line of the processor's cache."""

NO_ROW = -1
"""In a slot that is empty."""

_HASH_FACTOR = np.uint64(0x9E3779B97F4A7C15)


class KeyIndex:
    """Maps up to ``capacity`` positive int64 keys to int32 rows.

    ``keys``, ``rows``: the slots, a power of two of them; ``keys`` is ``NO_KEY`` where empty.
    """

    def __init__(self, capacity: int) -> None:
        slots = 1 << max(1, (2 * capacity - 1).bit_length())
        # Written at once, for hashing spreads the first frame's keys over all of their memory.
        self.keys: NDArray[np.int64] = np.full(slots, NO_KEY, np.int64)
        self.rows: NDArray[np.int32] = np.full(slots, NO_ROW, np.int32)

    @property
    def nbytes(self) -> int:
        """Bytes held by the slots."""
        return self.keys.nbytes + self.rows.nbytes

    def fill(self, keys: NDArray[np.int64]) -> None:
        """Put ``keys[row] -> row`` for every row; for an empty index."""
        _put_all(self.keys, self.rows, keys)


def are_unique_keys(keys: NDArray[np.int64]) -> bool:
    """Whether these are keys at all, and none of them twice."""
    return bool(np.all(keys > NO_KEY)) and len(np.unique(keys)) == len(keys)


@compiled
def _home_slot(slot_keys: NDArray[np.int64], key: int) -> int:
    mixed = np.uint64(key & _CELL) * _HASH_FACTOR
    in_cell = ((key >> (2 * COORDINATE_BITS)) & 1) << 2 | ((key >> COORDINATE_BITS) & 1) << 1
    return (int(mixed >> np.uint64(33)) << 3 | in_cell | (key & 1)) & (len(slot_keys) - 1)


@compiled
def find_row(slot_keys: NDArray[np.int64], slot_rows: NDArray[np.int32], key: int) -> int:
    """The row of ``key``, or -1."""
    mask = len(slot_keys) - 1
    slot = _home_slot(slot_keys, key)
    while slot_keys[slot] != NO_KEY:
        if slot_keys[slot] == key:
            return int(slot_rows[slot])
        slot = (slot + 1) & mask
    return -1


@compiled
def put_row(slot_keys: NDArray[np.int64], slot_rows: NDArray[np.int32], key: int, row: int) -> None:
    """Map ``key`` to ``row``, replacing what it mapped to."""
    mask = len(slot_keys) - 1
    slot = _home_slot(slot_keys, key)
    while slot_keys[slot] != NO_KEY and slot_keys[slot] != key:
        slot = (slot + 1) & mask
    slot_keys[slot] = key
    slot_rows[slot] = row


@compiled
def drop_key(slot_keys: NDArray[np.int64], slot_rows: NDArray[np.int32], key: int) -> None:
    """Forget ``key``, which must be present."""
    mask = len(slot_keys) - 1
    hole = _home_slot(slot_keys, key)
    while slot_keys[hole] != key:
        hole = (hole + 1) & mask
    slot = (hole + 1) & mask
    while slot_keys[slot] != NO_KEY:
        home = _home_slot(slot_keys, slot_keys[slot])
        if ((slot - home) & mask) >= ((slot - hole) & mask):
            slot_keys[hole] = slot_keys[slot]
            slot_rows[hole] = slot_rows[slot]
            hole = slot
        slot = (slot + 1) & mask
    slot_keys[hole] = NO_KEY


@compiled
def _put_all(
    slot_keys: NDArray[np.int64], slot_rows: NDArray[np.int32], keys: NDArray[np.int64]
) -> None:
    for row in range(len(keys)):
        put_row(slot_keys, slot_rows, keys[row], row)
