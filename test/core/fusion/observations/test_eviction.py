# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Eviction takes the least worthy voxels that the present frame does not see, and no more."""

import hypothesis.strategies as st
import numpy as np
from hypothesis import given

from reflest_core.fusion.observations.eviction import OBSERVATION_WORTH, least_worthy
from reflest_core.fusion.observations.observation_chunks import CHUNK

NOW = 100
voxels = st.lists(st.tuples(st.integers(0, NOW), st.integers(0, 64)), min_size=1, max_size=60)


def evicted(voxels, rows_wanted, chunks_wanted, frame_number=NOW):
    last_seen = np.array([v[0] for v in voxels], np.int32)
    counts = np.array([v[1] for v in voxels], np.uint8)
    found = least_worthy(last_seen, counts, frame_number, rows_wanted, chunks_wanted)
    worth = last_seen + OBSERVATION_WORTH * counts.astype(int)
    chunks = -(-counts.astype(int) // CHUNK)
    return found, last_seen, worth, chunks


@given(voxels, st.integers(0, 40), st.integers(0, 200))
def test_the_least_worthy_go_and_no_more_than_needed(voxels, rows_wanted, chunks_wanted):
    found, last_seen, worth, chunks = evicted(voxels, rows_wanted, chunks_wanted)
    unseen = np.flatnonzero(last_seen < NOW)
    kept = np.setdiff1d(unseen, found)
    assert np.all(np.diff(found) > 0)
    assert np.isin(found, unseen).all()
    if len(found) and len(kept):
        assert worth[found].max() <= worth[kept].min()
    freed_rows, freed_chunks = len(found), chunks[found].sum()
    is_enough = freed_rows >= rows_wanted and freed_chunks >= chunks_wanted
    assert is_enough or len(kept) == 0
    if len(found):
        last = found[np.lexsort((found, worth[found]))[-1]]
        without = freed_rows - 1, freed_chunks - chunks[last]
        assert without[0] < rows_wanted or without[1] < chunks_wanted


def test_recently_seen_and_often_seen_outlast_the_rest():
    old_once, old_often, new_once, seen_now = (10, 1), (10, 30), (60, 1), (NOW, 0)
    found, *_ = evicted([old_often, new_once, seen_now, old_once], 1, 0)
    assert found.tolist() == [3]
    found, *_ = evicted([old_often, new_once, seen_now, old_once], 2, 0)
    assert found.tolist() == [1, 3]
    found, *_ = evicted([old_often, new_once, seen_now, old_once], 9, 0)
    assert found.tolist() == [0, 1, 3]


def test_a_very_long_scan_is_ordered_too():
    frames = np.linspace(0, 2**30, 500).astype(int)
    found, *_ = evicted([(n, 0) for n in frames], 100, 0, 2**30 + 1)
    assert found.tolist() == list(range(100))
