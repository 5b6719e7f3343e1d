# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A hash table from voxel keys to rows, for kernels.

Half of its slots stay empty. Lookups do not depend on the order of insertion, removal shifts the
following entries back (Knuth, The Art of Computer Programming vol. 3, 6.4, algorithm R), so there
are no tombstones and no rehashing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.reserved import reserved
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

    Attributes:
        keys: (S,) int64 keys in the slots, a power of two of them; ``NO_KEY`` where empty.
        rows: (S,) int32 rows in the slots.
    """

    def __init__(self, capacity: int) -> None:
        """Reserve the slots.

        Args:
            capacity: Most keys.
        """
        slots = 1 << max(1, (2 * capacity - 1).bit_length())
        # Written at once, for hashing spreads the first frame's keys over all of their memory.
        self.keys: NDArray[np.int64] = reserved(slots, np.int64)
        self.rows: NDArray[np.int32] = reserved(slots, np.int32)
        self.keys.fill(NO_KEY)
        self.rows.fill(NO_ROW)

    @property
    def nbytes(self) -> int:
        """Bytes held by the slots."""
        return self.keys.nbytes + self.rows.nbytes

    def fill(self, keys: NDArray[np.int64]) -> None:
        """Map every key to its place; for an empty index.

        Args:
            keys: (N,) unique keys.
        """
        _put_all(self.keys, self.rows, keys)


def are_unique_keys(keys: NDArray[np.int64]) -> bool:
    """Check that these are keys at all, and none of them twice.

    Args:
        keys: (N,) int64.

    Returns:
        Whether they are.
    """
    return bool(np.all(keys > NO_KEY)) and len(np.unique(keys)) == len(keys)


@compiled
def _home_slot(slot_keys: NDArray[np.int64], key: int) -> int:
    mixed = np.uint64(key & _CELL) * _HASH_FACTOR
    in_cell = ((key >> (2 * COORDINATE_BITS)) & 1) << 2 | ((key >> COORDINATE_BITS) & 1) << 1
    return (int(mixed >> np.uint64(33)) << 3 | in_cell | (key & 1)) & (len(slot_keys) - 1)


@compiled
def find_row(slot_keys: NDArray[np.int64], slot_rows: NDArray[np.int32], key: int) -> int:
    """Look a key up; a kernel.

    Args:
        slot_keys: ``keys`` of the index.
        slot_rows: ``rows`` of the index.
        key: Any key.

    Returns:
        Its row, or -1.
    """
    mask = len(slot_keys) - 1
    slot = _home_slot(slot_keys, key)
    while slot_keys[slot] != NO_KEY:
        if slot_keys[slot] == key:
            return int(slot_rows[slot])
        slot = (slot + 1) & mask
    return -1


@compiled
def put_row(slot_keys: NDArray[np.int64], slot_rows: NDArray[np.int32], key: int, row: int) -> None:
    """Map a key to a row, replacing what it mapped to; a kernel.

    Args:
        slot_keys: ``keys`` of the index.
        slot_rows: ``rows`` of the index.
        key: Any key.
        row: Its row.
    """
    mask = len(slot_keys) - 1
    slot = _home_slot(slot_keys, key)
    while slot_keys[slot] != NO_KEY and slot_keys[slot] != key:
        slot = (slot + 1) & mask
    slot_keys[slot] = key
    slot_rows[slot] = row


@compiled
def drop_key(slot_keys: NDArray[np.int64], slot_rows: NDArray[np.int32], key: int) -> None:
    """Forget a key, which must be present; a kernel.

    Args:
        slot_keys: ``keys`` of the index.
        slot_rows: ``rows`` of the index.
        key: The key.
    """
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
