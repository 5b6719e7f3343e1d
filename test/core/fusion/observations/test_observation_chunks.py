# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The pool hands chunks out and takes them back without losing or sharing any."""

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from reflest_core.fusion.observations.observation_chunks import (
    CHUNK,
    NONE,
    ChunkPool,
    chunk_of_slot,
    release_chunk,
    take_chunk,
)

CAPACITY = 6


@given(st.lists(st.tuples(st.booleans(), st.integers(0, 2))))
def test_chains_behave_as_lists(steps):
    pool, chains = ChunkPool(CAPACITY), [[], [], []]
    for is_taking, owner in steps:
        chain = chains[owner]
        first = chain[0] if chain else NONE
        if is_taking:
            chunk = take_chunk(pool.chunks, first)
            if sum(map(len, chains)) == CAPACITY:
                assert chunk == NONE
            else:
                assert all(chunk not in other for other in chains)
                chain.insert(0, chunk)
        elif chain:
            assert release_chunk(pool.chunks, chain.pop(0)) == (chain[0] if chain else NONE)
        assert pool.taken == sum(map(len, chains))
        assert pool.count <= CAPACITY
        for chain in chains:
            for age, chunk in enumerate(reversed(chain)):
                held = chunk_of_slot(pool.chunks, chain[0], len(chain) * CHUNK, age * CHUNK + 3)
                assert held == chunk


def test_restored_pool_hands_out_what_no_voxel_holds():
    pool = ChunkPool(CAPACITY)
    pool.chunks.after[:4] = [NONE, 0, NONE, NONE]
    pool.restore(4, np.array([1, 3], np.int32), np.array([12, 1], np.uint8))
    assert (pool.count, pool.taken, pool.observations) == (4, 3, 13)
    assert [take_chunk(pool.chunks, NONE) for _ in range(4)] == [2, 4, 5, NONE]


@pytest.mark.parametrize(
    ("first_chunks", "counts"),
    [([1, 0], [12, 1]), ([4], [1]), ([-2], [1]), ([1], [20]), ([1], [3]), ([0], [0])],
)
def test_shared_missing_and_surplus_chunks_are_refused(first_chunks, counts):
    pool = ChunkPool(CAPACITY)
    pool.chunks.after[:4] = [NONE, 0, NONE, NONE]
    with pytest.raises(ValueError, match="not its own"):
        pool.restore(4, np.array(first_chunks, np.int32), np.array(counts, np.uint8))
