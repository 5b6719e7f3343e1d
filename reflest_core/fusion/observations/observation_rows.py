# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The rows of the observation store, and the kernels that change them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.observations.observation_chunks import (
    CHUNK,
    NONE,
    OBSERVATIONS,
    ObservationChunks,
    chunk_of_slot,
    copy_observations,
    release_chunk,
    take_chunk,
)
from reflest_core.fusion.observations.observation_replacement import (
    closest_pair,
    directions_to_views,
    slot_to_replace,
)
from reflest_core.jit import compiled
from reflest_core.surface.key_index import drop_key, find_row, put_row
from reflest_core.surface.voxel_key import NO_KEY


class ObservationRows(NamedTuple):
    """R rows, one for each voxel.

    Attributes:
        index_keys: (S,) int64, slots of the :class:`.KeyIndex`.
        index_rows: (S,) int32, slots of the :class:`.KeyIndex`.
        keys: (R,) int64 voxel keys.
        positions: (R, 3) float32, world frame, metres.
        normals: (R, 3) float32, unit.
        last_seen: (R,) int32 frame number.
        counts: (R,) uint8 observations.
        pairs: (R, 2) uint8, slots of the closest pair of directions of a full row, equal where
            unknown.
        first_chunks: (R,) int32, where the observations are (:mod:`.observation_chunks`).
    """

    index_keys: NDArray[np.int64]
    index_rows: NDArray[np.int32]
    keys: NDArray[np.int64]
    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    last_seen: NDArray[np.int32]
    counts: NDArray[np.uint8]
    pairs: NDArray[np.uint8]
    first_chunks: NDArray[np.int32]


@compiled
def find_rows(
    start: int, stop: int, rows: ObservationRows, keys: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Look keys up.

    Args:
        start: First key.
        stop: Key after the last.
        rows: The store's rows.
        keys: (N,) voxel keys.

    Returns:
        The row of each of ``keys[start:stop]``, -1 where it has none.
    """
    found = np.empty(stop - start, np.int64)
    for n in range(start, stop):
        found[n - start] = find_row(rows.index_keys, rows.index_rows, keys[n])
    return found


@compiled
def refresh_rows(
    start: int,
    stop: int,
    rows: ObservationRows,
    selected: NDArray[np.int64],
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
) -> None:
    """Renew positions and normals of rows.

    Args:
        start: First of ``selected``.
        stop: The one after the last.
        rows: The store's rows.
        selected: (S,) rows, -1 for none.
        positions: (S, 3) world frame, metres.
        normals: (S, 3) unit.
    """
    for n in range(start, stop):
        row = selected[n]
        if row >= 0:
            for axis in range(3):
                rows.positions[row, axis] = positions[n, axis]
                rows.normals[row, axis] = normals[n, axis]


@compiled
def append_rows(
    rows: ObservationRows,
    count: int,
    keys: NDArray[np.int64],
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
) -> int:
    """Add voxels that are not stored yet, without observations.

    Args:
        rows: The store's rows.
        count: Rows in use.
        keys: (N,) voxel keys.
        positions: (N, 3) world frame, metres.
        normals: (N, 3) unit.

    Returns:
        The new number of rows in use.
    """
    for n in range(len(keys)):
        put_row(rows.index_keys, rows.index_rows, keys[n], count)
        rows.keys[count] = keys[n]
        rows.positions[count] = positions[n]
        rows.normals[count] = normals[n]
        rows.counts[count] = 0
        rows.pairs[count] = 0
        rows.first_chunks[count] = NONE
        count += 1
    return count


@compiled
def remove_row(rows: ObservationRows, chunks: ObservationChunks, count: int, row: int) -> int:
    """Remove a row and fill its place with the last one.

    Args:
        rows: The store's rows.
        chunks: The store's chunks.
        count: Rows in use.
        row: The row.

    Returns:
        The new number of rows in use.
    """
    chunks.state[OBSERVATIONS] -= rows.counts[row]
    chunk = int(rows.first_chunks[row])
    while chunk != NONE:
        chunk = release_chunk(chunks, chunk)
    drop_key(rows.index_keys, rows.index_rows, rows.keys[row])
    last = count - 1
    if row != last:
        put_row(rows.index_keys, rows.index_rows, rows.keys[last], row)
        rows.keys[row] = rows.keys[last]
        rows.positions[row] = rows.positions[last]
        rows.normals[row] = rows.normals[last]
        rows.last_seen[row] = rows.last_seen[last]
        rows.counts[row] = rows.counts[last]
        rows.pairs[row] = rows.pairs[last]
        rows.first_chunks[row] = rows.first_chunks[last]
    return last


@compiled
def remove_keys(
    rows: ObservationRows, chunks: ObservationChunks, count: int, keys: NDArray[np.int64]
) -> int:
    """Remove voxels, stored or not.

    Args:
        rows: The store's rows.
        chunks: The store's chunks.
        count: Rows in use.
        keys: (N,) voxel keys.

    Returns:
        The new number of rows in use.
    """
    for n in range(len(keys)):
        row = find_row(rows.index_keys, rows.index_rows, keys[n])
        if row >= 0:
            count = remove_row(rows, chunks, count, row)
    return count


@compiled
def move_keys(
    rows: ObservationRows,
    chunks: ObservationChunks,
    count: int,
    left: NDArray[np.int64],
    left_to: NDArray[np.int64],
) -> int:
    """Hand each voxel's observations to the voxel that its surface moved to.

    Of two voxels that meet, the one with more observations is kept.

    Args:
        rows: The store's rows.
        chunks: The store's chunks.
        count: Rows in use.
        left: (L,) voxels that left the surface.
        left_to: (L,) voxels that their surface moved to; ``NO_KEY`` removes.

    Returns:
        The new number of rows in use.
    """
    for n in range(len(left)):
        row = find_row(rows.index_keys, rows.index_rows, left[n])
        if row < 0:
            continue
        other = -1
        if left_to[n] != NO_KEY:
            other = find_row(rows.index_keys, rows.index_rows, left_to[n])
        if left_to[n] == NO_KEY or (other >= 0 and rows.counts[other] >= rows.counts[row]):
            count = remove_row(rows, chunks, count, row)
            continue
        if other >= 0:
            count = remove_row(rows, chunks, count, other)
            row = find_row(rows.index_keys, rows.index_rows, left[n])
        drop_key(rows.index_keys, rows.index_rows, left[n])
        rows.keys[row] = left_to[n]
        put_row(rows.index_keys, rows.index_rows, left_to[n], row)
    return count


@compiled
def observe_rows(
    start: int,
    stop: int,
    rows: ObservationRows,
    chunks: ObservationChunks,
    slots: int,
    selected: NDArray[np.int64],
    colours: NDArray[np.uint8],
    view: int,
    view_centres: NDArray[np.float32],
) -> int:
    """Add one observation to each of some rows.

    A row is full with ``slots`` observations, or with what it has if no chunk is left. Rows with
    ``slots`` observations keep their chunks, so that threads may share them.

    Args:
        start: First of ``selected``.
        stop: The one after the last.
        rows: The store's rows.
        chunks: The store's chunks.
        slots: Observations that a row may have.
        selected: (S,) rows.
        colours: (S, 3) 8-bit sRGB.
        view: Id of the view that observes.
        view_centres: (W, 3) camera centres of all views, world frame, metres.

    Returns:
        How many observations were kept.
    """
    directions = np.empty((3, slots + 1), np.float64)
    old_colours = np.empty((slots, 3), np.uint8)
    views = np.empty(slots + 1, np.uint16)
    kept = 0
    for n in range(start, stop):
        row = selected[n]
        count = int(rows.counts[row])
        chunk, slot = int(rows.first_chunks[row]), count
        is_full = count == slots
        if not is_full and count % CHUNK == 0:
            chunk = take_chunk(chunks, chunk)
            is_full = chunk == NONE
        if not is_full:
            rows.first_chunks[row] = chunk
            rows.counts[row] = count + 1
            chunks.state[OBSERVATIONS] += 1
            rows.pairs[row] = 0
        elif count < 2:
            continue
        else:
            first = int(rows.first_chunks[row])
            copy_observations(chunks, first, count, old_colours, views)
            views[count] = view
            directions_to_views(rows.positions[row], views, count + 1, view_centres, directions)
            if rows.pairs[row, 0] == rows.pairs[row, 1]:
                rows.pairs[row, 0], rows.pairs[row, 1] = closest_pair(directions, count)
            pair = (int(rows.pairs[row, 0]), int(rows.pairs[row, 1]))
            slot = slot_to_replace(directions, count, pair)
            if slot < 0:
                continue
            directions[:, slot] = directions[:, count]
            rows.pairs[row, 0], rows.pairs[row, 1] = closest_pair(directions, count)
            chunk = chunk_of_slot(chunks, first, count, slot)
        for channel in range(3):
            chunks.colours[chunk, slot % CHUNK, channel] = colours[n, channel]
        chunks.view_ids[chunk, slot % CHUNK] = view
        kept += 1
    return kept


@compiled
def drop_views(
    rows: ObservationRows, chunks: ObservationChunks, count: int, is_one: NDArray[np.bool_]
) -> None:
    """Remove every observation of some views; rows stay.

    Args:
        rows: The store's rows.
        chunks: The store's chunks.
        count: Rows in use.
        is_one: (65536,) whether each view id is one of them.
    """
    for row in range(count):
        slot = 0
        while slot < rows.counts[row]:
            had = int(rows.counts[row])
            first = int(rows.first_chunks[row])
            chunk = chunk_of_slot(chunks, first, had, slot)
            if not is_one[chunks.view_ids[chunk, slot % CHUNK]]:
                slot += 1
                continue
            last = (had - 1) % CHUNK
            chunks.colours[chunk, slot % CHUNK] = chunks.colours[first, last]
            chunks.view_ids[chunk, slot % CHUNK] = chunks.view_ids[first, last]
            rows.counts[row] = had - 1
            chunks.state[OBSERVATIONS] -= 1
            rows.pairs[row] = 0
            if last == 0:
                rows.first_chunks[row] = release_chunk(chunks, first)
