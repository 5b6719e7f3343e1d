# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Kernels that read the rows of the observation store."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.observations.observation_chunks import (
    CHUNK,
    ObservationChunks,
    copy_observations,
)
from reflest_core.fusion.observations.observation_rows import ObservationRows
from reflest_core.jit import compiled


@compiled
def has_seen(
    rows: ObservationRows, chunks: ObservationChunks, row: int, is_one: NDArray[np.bool_]
) -> bool:
    """Decide whether one of some views observed a row.

    Args:
        rows: The store's rows.
        chunks: The store's chunks.
        row: The row.
        is_one: (65536,) whether each view id is one of them.

    Returns:
        Whether one did.
    """
    chunk, left = rows.first_chunks[row], int(rows.counts[row])
    while left > 0:
        in_chunk = (left - 1) % CHUNK + 1
        for slot in range(in_chunk):
            if is_one[chunks.view_ids[chunk, slot]]:
                return True
        chunk = chunks.after[chunk]
        left -= in_chunk
    return False


@compiled
def rows_unseen_from(
    start: int,
    stop: int,
    rows: ObservationRows,
    chunks: ObservationChunks,
    selected: NDArray[np.int64],
    is_one: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Find the rows that none of some views observed.

    Args:
        start: First of ``selected``.
        stop: The one after the last.
        rows: The store's rows.
        chunks: The store's chunks.
        selected: (S,) rows.
        is_one: (65536,) whether each view id is one of them.

    Returns:
        True for those of ``selected[start:stop]`` that none observed.
    """
    unseen = np.empty(stop - start, np.bool_)
    for n in range(start, stop):
        unseen[n - start] = not has_seen(rows, chunks, selected[n], is_one)
    return unseen


@compiled
def gather_observations(
    start: int,
    stop: int,
    rows: ObservationRows,
    chunks: ObservationChunks,
    selected: NDArray[np.int64],
    offsets: NDArray[np.int64],
    colours: NDArray[np.uint8],
    view_ids: NDArray[np.uint16],
) -> None:
    """Copy the observations of rows one after another.

    Args:
        start: First of ``selected``.
        stop: The one after the last.
        rows: The store's rows.
        chunks: The store's chunks.
        selected: (S,) rows.
        offsets: (S + 1,) where each row's observations begin.
        colours: (O, 3) filled.
        view_ids: (O,) filled.
    """
    for n in range(start, stop):
        row = selected[n]
        copy_observations(
            chunks,
            rows.first_chunks[row],
            int(rows.counts[row]),
            colours[offsets[n] :],
            view_ids[offsets[n] :],
        )
