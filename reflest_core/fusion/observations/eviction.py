# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which voxels give way when a new one finds no room.

Worth is ``last_seen + OBSERVATION_WORTH * observations``, in frames: what was seen long ago goes
before what was seen recently, and a voxel seen from many views (which ``observation_replacement``
and ``view_spacing`` keep spread over directions) outlasts one seen from few. A voxel that the
present frame sees never goes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.observations.observation_chunks import CHUNK
from reflest_core.jit import compiled

OBSERVATION_WORTH = 4
"""Frames for which one more observation prolongs a voxel's stay."""

_BUCKETS = 1 << 16
"""Worths further apart than this many frames are ordered more coarsely: to 1/65536 of all."""


@compiled
def least_worthy(
    last_seen: NDArray[np.int32],
    counts: NDArray[np.uint8],
    frame_number: int,
    rows_wanted: int,
    chunks_wanted: int,
) -> NDArray[np.int64]:
    """Choose the rows that must go; a kernel.

    Of equal worth, the lower rows go. Takes time in proportion to the rows.

    Args:
        last_seen: (R,) frame number at which each row was seen last.
        counts: (R,) observations of each row.
        frame_number: Rows seen in this frame never go.
        rows_wanted: Rows to free.
        chunks_wanted: Chunks of observations to free.

    Returns:
        The least worthy rows, rising; all that may go, if these are not enough.
    """
    least, most = np.int64(1) << 62, np.int64(0)
    for row in range(len(last_seen)):
        if last_seen[row] < frame_number:
            worth = np.int64(last_seen[row]) + OBSERVATION_WORTH * np.int64(counts[row])
            least, most = min(least, worth), max(most, worth)
    width = max(np.int64(0), most - least) // _BUCKETS + 1
    rows_in = np.zeros(_BUCKETS, np.int64)
    chunks_in = np.zeros(_BUCKETS, np.int64)
    for row in range(len(last_seen)):
        if last_seen[row] < frame_number:
            worth = np.int64(last_seen[row]) + OBSERVATION_WORTH * np.int64(counts[row])
            rows_in[(worth - least) // width] += 1
            chunks_in[(worth - least) // width] += (np.int64(counts[row]) + CHUNK - 1) // CHUNK
    last = 0
    while last < _BUCKETS and (rows_wanted > rows_in[last] or chunks_wanted > chunks_in[last]):
        rows_wanted -= int(rows_in[last])
        chunks_wanted -= int(chunks_in[last])
        last += 1
    found = np.empty(len(last_seen), np.int64)
    count = 0
    for row in range(len(last_seen)):
        if last_seen[row] >= frame_number:
            continue
        worth = np.int64(last_seen[row]) + OBSERVATION_WORTH * np.int64(counts[row])
        bucket = (worth - least) // width
        if bucket == last and (rows_wanted > 0 or chunks_wanted > 0):
            rows_wanted -= 1
            chunks_wanted -= (int(counts[row]) + CHUNK - 1) // CHUNK
        elif bucket >= last:
            continue
        found[count] = row
        count += 1
    return found[:count].copy()
