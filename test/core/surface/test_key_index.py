# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import hypothesis.strategies as st
import numpy as np
from hypothesis import given

from reflest_core.surface.key_index import (
    BYTES_PER_ROW,
    KeyIndex,
    are_unique_keys,
    drop_key,
    find_row,
    put_row,
)

CAPACITY = 24
keys = st.integers(1, 40)


@given(st.lists(st.tuples(st.sampled_from(["put", "drop"]), keys, st.integers(0, 999))))
def test_behaves_as_a_dictionary(steps):
    index, model = KeyIndex(CAPACITY), {}
    for action, key, row in steps:
        if action == "put" and (key in model or len(model) < CAPACITY):
            put_row(index.keys, index.rows, key, row)
            model[key] = row
        elif action == "drop" and key in model:
            drop_key(index.keys, index.rows, key)
            del model[key]
        for probe in range(1, 41):
            assert find_row(index.keys, index.rows, probe) == model.get(probe, -1)


def test_fill_maps_each_key_to_its_position():
    wanted = np.array([7, 3, 1 << 62, 12], np.int64)
    index = KeyIndex(len(wanted))
    index.fill(wanted)
    assert [find_row(index.keys, index.rows, key) for key in wanted] == [0, 1, 2, 3]


@given(st.integers(1, 10_000))
def test_bytes_stay_below_the_stated_bound(capacity):
    index = KeyIndex(capacity)
    assert index.nbytes <= capacity * BYTES_PER_ROW
    assert len(index.keys) >= 2 * capacity


def test_unique_keys():
    assert are_unique_keys(np.array([3, 1, 2], np.int64))
    assert not are_unique_keys(np.array([3, 1, 3], np.int64))
    assert not are_unique_keys(np.array([3, 0], np.int64))
