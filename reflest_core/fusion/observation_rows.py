"""The inner loops of the observation store: finding, moving and removing its rows.

All take ``rows``, the tuple of the store's arrays in the order of ``ObservationRows``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.key_index import drop_key, find_row, put_row
from reflest_core.fusion.observation_replacement import (
    closest_pair,
    directions_to_views,
    slot_to_replace,
)
from reflest_core.fusion.voxel_key import NO_KEY
from reflest_core.jit import compiled


class ObservationRows(NamedTuple):
    """R rows of K slots; a row's first ``counts`` slots hold an observation each.

    ``index_keys``, ``index_rows``: slots of the :class:`KeyIndex`. ``keys``: (R,) int64 voxel keys.
    ``positions``, ``normals``: (R, 3) float32. ``last_seen``: (R,) int64 frame number.
    ``counts``: (R,) uint8. ``pairs``: (R, 2) uint8, slots of the closest pair of directions of a
    full row, equal where unknown. ``colours``: (R, K, 3) uint8. ``view_ids``: (R, K) uint16.
    """

    index_keys: NDArray[np.int64]
    index_rows: NDArray[np.int32]
    keys: NDArray[np.int64]
    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    last_seen: NDArray[np.int64]
    counts: NDArray[np.uint8]
    pairs: NDArray[np.uint8]
    colours: NDArray[np.uint8]
    view_ids: NDArray[np.uint16]


@compiled
def find_rows(
    start: int, stop: int, rows: ObservationRows, keys: NDArray[np.int64]
) -> NDArray[np.int64]:
    """The row of each of ``keys[start:stop]``, -1 where it has none."""
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
    """Give the rows ``selected[start:stop]`` (-1: none) their new position and normal."""
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
    """Add voxels that are not stored yet, without observations; return the new row count."""
    for n in range(len(keys)):
        put_row(rows.index_keys, rows.index_rows, keys[n], count)
        rows.keys[count] = keys[n]
        rows.positions[count] = positions[n]
        rows.normals[count] = normals[n]
        rows.counts[count] = 0
        rows.pairs[count] = 0
        count += 1
    return count


@compiled
def remove_row(rows: ObservationRows, count: int, row: int) -> int:
    """Remove a row and fill its place with the last one; return the new row count."""
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
        rows.colours[row] = rows.colours[last]
        rows.view_ids[row] = rows.view_ids[last]
    return last


@compiled
def remove_keys(rows: ObservationRows, count: int, keys: NDArray[np.int64]) -> int:
    """Remove the stored ones of these voxels; return the new row count."""
    for n in range(len(keys)):
        row = find_row(rows.index_keys, rows.index_rows, keys[n])
        if row >= 0:
            count = remove_row(rows, count, row)
    return count


@compiled
def move_keys(
    rows: ObservationRows, count: int, left: NDArray[np.int64], left_to: NDArray[np.int64]
) -> int:
    """Hand each voxel's observations to the voxel its surface moved to; return the row count.

    Of two voxels that meet, the one with more observations is kept. ``NO_KEY`` removes.
    """
    for n in range(len(left)):
        row = find_row(rows.index_keys, rows.index_rows, left[n])
        if row < 0:
            continue
        other = -1
        if left_to[n] != NO_KEY:
            other = find_row(rows.index_keys, rows.index_rows, left_to[n])
        if left_to[n] == NO_KEY or (other >= 0 and rows.counts[other] >= rows.counts[row]):
            count = remove_row(rows, count, row)
            continue
        if other >= 0:
            count = remove_row(rows, count, other)
            row = find_row(rows.index_keys, rows.index_rows, left[n])
        drop_key(rows.index_keys, rows.index_rows, left[n])
        rows.keys[row] = left_to[n]
        put_row(rows.index_keys, rows.index_rows, left_to[n], row)
    return count


@compiled
def rows_unseen_from(
    rows: ObservationRows, selected: NDArray[np.int64], views: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """(S,) True for the selected rows that have no observation from any of ``views``."""
    is_one = np.zeros(1 << 16, np.bool_)
    for view in views:
        is_one[view] = True
    unseen = np.ones(len(selected), np.bool_)
    for n in range(len(selected)):
        row = selected[n]
        for slot in range(rows.counts[row]):
            if is_one[rows.view_ids[row, slot]]:
                unseen[n] = False
                break
    return unseen


@compiled
def observe_rows(
    rows: ObservationRows,
    selected: NDArray[np.int64],
    colours: NDArray[np.uint8],
    view: int,
    view_centres: NDArray[np.float32],
) -> int:
    """Add one observation of ``view`` to each selected row; return how many were kept."""
    slots = rows.view_ids.shape[1]
    directions = np.empty((3, slots + 1), np.float64)
    views = np.empty(slots + 1, np.uint16)
    kept = 0
    for n in range(len(selected)):
        row = selected[n]
        slot = int(rows.counts[row])
        if slot == slots:
            views[:slots] = rows.view_ids[row]
            views[slots] = view
            directions_to_views(rows.positions[row], views, slots + 1, view_centres, directions)
            if rows.pairs[row, 0] == rows.pairs[row, 1]:
                rows.pairs[row, 0], rows.pairs[row, 1] = closest_pair(directions, slots)
            pair = (int(rows.pairs[row, 0]), int(rows.pairs[row, 1]))
            slot = slot_to_replace(directions, slots, pair)
            if slot < 0:
                continue
            directions[:, slot] = directions[:, slots]
            rows.pairs[row, 0], rows.pairs[row, 1] = closest_pair(directions, slots)
        else:
            rows.counts[row] += 1
        rows.colours[row, slot] = colours[n]
        rows.view_ids[row, slot] = view
        kept += 1
    return kept


@compiled
def drop_view(rows: ObservationRows, count: int, view: int) -> None:
    """Remove every observation of ``view``; rows stay."""
    for row in range(count):
        for slot in range(rows.counts[row]):
            if rows.view_ids[row, slot] == view:
                last = rows.counts[row] - 1
                rows.colours[row, slot] = rows.colours[row, last]
                rows.view_ids[row, slot] = rows.view_ids[row, last]
                rows.counts[row] = last
                rows.pairs[row] = 0
                break


@compiled
def gather_observations(
    rows: ObservationRows, selected: NDArray[np.int64], offsets: NDArray[np.int64]
) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
    """Copy the selected rows' observations into (O, 3) colours and (O,) view ids."""
    colours = np.empty((offsets[-1], 3), np.uint8)
    view_ids = np.empty(offsets[-1], np.uint16)
    for n in range(len(selected)):
        row = selected[n]
        first, last = offsets[n], offsets[n + 1]
        colours[first:last] = rows.colours[row, : last - first]
        view_ids[first:last] = rows.view_ids[row, : last - first]
    return colours, view_ids
