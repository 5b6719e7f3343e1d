# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Ids of materials over keyframes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from reflest_core.segmentation.identity import MOST_MATERIALS, MaterialIds
from reflest_core.surface.material_ids import FIRST_ID, MOST_IDS, GivenIds

KEYS = np.arange(100, 200)
HALVES = np.repeat([0, 1], 50)


def test_first_ids_count_from_one():
    np.testing.assert_array_equal(MaterialIds().match(KEYS, HALVES), [FIRST_ID, FIRST_ID + 1])


def test_the_same_materials_keep_their_ids_under_other_labels_and_orders():
    ids = MaterialIds()
    first = ids.match(KEYS, HALVES)
    order = np.random.default_rng(0).permutation(100)
    second = ids.match(KEYS[order], 1 - HALVES[order])
    np.testing.assert_array_equal(second, first[::-1])


def test_a_growing_material_keeps_its_id():
    ids = MaterialIds()
    first = ids.match(KEYS[:20], np.zeros(20, int))
    np.testing.assert_array_equal(ids.match(KEYS, np.zeros(100, int)), first)


def test_the_larger_part_of_a_split_material_keeps_its_id_and_the_other_is_new():
    ids = MaterialIds()
    (whole,) = ids.match(KEYS, np.zeros(100, int))
    parts = ids.match(KEYS, (np.arange(100) < 30).astype(int))
    np.testing.assert_array_equal(parts, [whole, whole + 1])


def test_joined_materials_keep_the_id_of_the_larger_and_the_other_never_returns():
    ids = MaterialIds()
    small, large = ids.match(KEYS, (np.arange(100) >= 30).astype(int))
    assert ids.match(KEYS, np.zeros(100, int)) == [large]
    again = ids.match(KEYS, (np.arange(100) >= 30).astype(int))
    assert large in again
    assert small not in again


@pytest.mark.parametrize("ids", [np.full(100, MOST_IDS - 1), np.zeros(0, np.int64)])
def test_ids_begin_again_after_the_last(ids):
    given_ids = MaterialIds(GivenIds(KEYS[: len(ids)], ids, MOST_IDS))
    labels = np.arange(100) // 20
    first = given_ids.match(KEYS, labels)
    np.testing.assert_array_equal(first, FIRST_ID + np.arange(5))
    np.testing.assert_array_equal(given_ids.match(KEYS, labels), first)


def test_the_last_ids_are_given():
    ids = MaterialIds(GivenIds(next_id=MOST_IDS - 2)).match(KEYS, HALVES)
    np.testing.assert_array_equal(ids, [MOST_IDS - 2, MOST_IDS - 1])


def test_what_left_the_view_gets_a_new_id_when_it_returns():
    ids = MaterialIds()
    ids.match(KEYS, HALVES)
    ids.match(KEYS[50:], np.zeros(50, int))
    assert ids.match(KEYS, HALVES).max() == FIRST_ID + 2


def test_voxels_without_a_material_have_no_part_in_it():
    ids = MaterialIds()
    labels = np.where(np.arange(100) < 10, 0, -1)
    assert ids.match(KEYS, labels) == [FIRST_ID]
    assert len(ids.given.keys) == 10


def test_nothing_has_no_ids():
    ids = MaterialIds()
    nothing = np.zeros(0, np.int64)
    assert len(ids.match(nothing, nothing)) == 0
    assert ids.match(KEYS[:1], np.zeros(1, int)) == [FIRST_ID]
    assert len(ids.match(nothing, nothing)) == 0


def test_more_materials_than_a_map_holds_are_refused():
    keys = np.arange(MOST_MATERIALS + 1)
    with pytest.raises(ValueError, match="257 materials where at most 256"):
        MaterialIds().match(keys, keys)


def test_a_million_voxels_keep_their_ids():
    keys = np.arange(1, 1_000_001)
    labels = keys % MOST_MATERIALS
    ids = MaterialIds()
    first = ids.match(keys, labels)
    np.testing.assert_array_equal(ids.match(keys[::-1], labels[::-1]), first)


LABELS = npst.arrays(np.int64, 30, elements=st.integers(-1, 5))


@given(st.lists(LABELS, min_size=2, max_size=6), st.randoms(use_true_random=False))
def test_ids_are_one_to_one_never_return_and_do_not_hang_on_the_order(frames, random):
    ids, permuted = MaterialIds(), MaterialIds()
    order = np.array(random.sample(range(30), 30))
    alive, gone = set(), set()
    for labels in frames:
        found = ids.match(KEYS[:30], labels)
        np.testing.assert_array_equal(permuted.match(KEYS[:30][order], labels[order]), found)
        now = set(found.tolist())
        assert len(now) == len(found)
        assert not now & gone
        gone |= alive - now
        alive = now
