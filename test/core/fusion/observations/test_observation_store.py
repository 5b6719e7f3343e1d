# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import hypothesis.strategies as st
import numpy as np
from hypothesis import given, settings

from reflest_core.fusion.observations.eviction import OBSERVATION_WORTH
from reflest_core.fusion.observations.observation_chunks import BYTES_PER_CHUNK, CHUNK
from reflest_core.fusion.observations.observation_store import BYTES_PER_VOXEL, ObservationStore

CENTRES = np.random.default_rng(1).normal(size=(300, 3)).astype(np.float32)


def vectors(keys):
    """A position and a normal that tell which key they belong to."""
    keys = np.asarray(keys, np.float32)
    return np.stack([keys, keys, keys], 1), np.stack([keys, -keys, keys], 1)


def see(store, keys, view, frame_number):
    keys = np.asarray(keys, np.int64)
    rows = store.claim(keys, store.find(keys), *vectors(keys), frame_number)
    colours = np.stack([keys % 251, np.full(len(keys), view), keys % 7], 1).astype(np.uint8)
    store.observe(rows[rows >= 0], colours[rows >= 0], view, CENTRES)
    return rows


def contents(store):
    """{key: {view: colour}} with the store's own invariants checked."""
    found, total = {}, 0
    for row in range(store.count):
        key, n = int(store.rows.keys[row]), int(store.rows.counts[row])
        assert store.find(np.array([key]))[0] == row
        colours, views = store.observations(np.array([row]))
        found[key] = dict(zip(views.tolist(), colours.tolist(), strict=True))
        assert len(found[key]) == n
        total += n
    assert store.observation_count == total
    chunks = -(-store.rows.counts[: store.count].astype(int) // CHUNK)
    assert store.pool.taken == chunks.sum() <= store.pool.count <= store.pool.capacity
    return found


def test_observations_come_back_as_they_went_in():
    store = ObservationStore(100, 100, 5)
    see(store, [10, 20, 30], view=3, frame_number=1)
    see(store, [30, 40], view=4, frame_number=2)
    assert contents(store) == {
        10: {3: [10, 3, 3]},
        20: {3: [20, 3, 6]},
        30: {3: [30, 3, 2], 4: [30, 4, 2]},
        40: {4: [40, 4, 5]},
    }
    assert store.observation_count == 5


def test_refresh_renews_only_stored_voxels():
    store = ObservationStore(10, 10, 5)
    see(store, [1, 2], 0, 1)
    keys = np.array([2, 3])
    store.refresh(store.find(keys), np.full((2, 3), 9, np.float32), np.full((2, 3), 8, np.float32))
    assert store.count == 2
    np.testing.assert_array_equal(store.rows.positions[:2], [[1, 1, 1], [9, 9, 9]])
    np.testing.assert_array_equal(store.rows.normals[:2], [[1, -1, 1], [8, 8, 8]])


def test_moved_voxel_keeps_its_observations():
    store = ObservationStore(10, 10, 5)
    see(store, [1, 2], 0, 1)
    store.move(np.array([1, 2]), np.array([5, 0]))
    assert contents(store) == {5: {0: [1, 0, 1]}}


def test_of_two_voxels_that_meet_the_richer_survives():
    store = ObservationStore(10, 10, 5)
    see(store, [1, 2, 3], 0, 1)
    see(store, [1, 2], 1, 2)
    see(store, [2], 2, 3)
    store.move(np.array([2, 3]), np.array([1, 1]))
    assert contents(store) == {1: {0: [2, 0, 2], 1: [2, 1, 2], 2: [2, 2, 2]}}


def test_unseen_from_looks_for_any_of_the_views():
    store = ObservationStore(10, 10, 5)
    rows = see(store, [1, 2, 3], 0, 1)
    see(store, [2], 7, 2)
    assert store.unseen_from(rows, np.array([7, 9])).tolist() == [True, False, True]
    assert store.unseen_from(rows, np.array([], np.int64)).all()


def test_dropped_view_leaves_the_others():
    store = ObservationStore(10, 10, 5)
    see(store, [1, 2], 0, 1)
    see(store, [1], 1, 2)
    see(store, [1], 2, 3)
    store.drop_views(np.array([0]))
    assert contents(store) == {1: {1: [1, 1, 1], 2: [1, 2, 1]}, 2: {}}


def test_dropping_a_view_of_a_full_voxel_makes_room_again():
    store = ObservationStore(2, 2, 5)
    for view in range(8):
        see(store, [1], view, view)
    store.drop_views(store.observations(np.array([0]))[1][:1])
    assert store.rows.counts[0] == 4
    see(store, [1], 100, 9)
    see(store, [1], 101, 10)
    assert store.rows.counts[0] == 5
    contents(store)


def test_eviction_takes_the_least_worthy_that_the_frame_does_not_see():
    store = ObservationStore(4, 4, 5)
    see(store, [1], 0, 1)
    see(store, [2], 1, 2)
    for n in range(3):
        see(store, [3], 2 + n, 3 + n)
    see(store, [4], 9, 6)
    # worth: 1 -> 1 + 4, 2 -> 2 + 4, 3 -> 5 + 12, 4 -> 6 + 4
    see(store, [5, 1], 10, 7)
    assert sorted(contents(store)) == [1, 3, 4, 5]


def test_many_observations_outlast_recency_only_so_long():
    store = ObservationStore(2, 2, 5)
    for view in range(3):
        see(store, [1], view, 1)
    see(store, [2], 3, 1 + 2 * OBSERVATION_WORTH + 1)
    see(store, [3], 4, 50)
    assert sorted(contents(store)) == [2, 3]


def test_frame_larger_than_the_store_fills_it_and_no_more():
    store = ObservationStore(4, 4, 5)
    see(store, [1, 2, 3], 0, 1)
    rows = see(store, [3, 10, 11, 12, 13, 14], 1, 2)
    assert (rows >= 0).tolist() == [True, True, True, True, False, False]
    assert sorted(contents(store)) == [3, 10, 11, 12]


frame_keys = st.lists(st.integers(1, 60), min_size=1, max_size=20, unique=True)
actions = st.sampled_from(["see", "see", "see", "remove", "move", "drop"])


@settings(max_examples=100)
@given(st.integers(3, 20), st.lists(st.tuples(frame_keys, actions), max_size=40))
def test_capacity_is_never_passed_and_nothing_is_lost_track_of(chunks, steps):
    store = ObservationStore(16, chunks, 12)
    reserved = store.nbytes
    for n, (keys, action) in enumerate(steps):
        keys = np.array(keys, np.int64)
        if action == "see":
            rows = see(store, keys, n % 256, n + 1)
            assert len(set(rows[rows >= 0])) == np.sum(rows >= 0)
        elif action == "remove":
            store.remove(keys)
        elif action == "move":
            store.move(keys, np.roll(keys, 1))
        else:
            store.drop_views(np.array([n // 2, n // 3]))
        contents(store)
        assert store.count <= store.capacity
        assert store.nbytes == reserved <= 16 * BYTES_PER_VOXEL + chunks * BYTES_PER_CHUNK + 100


def test_without_chunks_a_voxel_trades_its_observations_for_better_spread_ones():
    store = ObservationStore(2, 1, 64)
    for view in range(8):
        see(store, [1], view, view + 1)
    before = contents(store)[1]
    for view in range(8, 40):
        see(store, [1], view, view + 1)
    after = contents(store)[1]
    assert len(before) == len(after) == 8
    assert set(after) - set(before)


def test_what_is_seen_now_takes_the_chunks_of_what_was_seen_before():
    store = ObservationStore(10, 4, 64)
    see(store, [1, 2, 3, 4], 0, 1)
    see(store, [5, 6], 1, 2)
    assert {key: len(views) for key, views in contents(store).items()} == {3: 1, 4: 1, 5: 1, 6: 1}


def test_an_observation_costs_at_most_six_bytes_and_a_voxel_a_stated_overhead():
    assert BYTES_PER_CHUNK / CHUNK <= 6.0
    few, many = ObservationStore(1000, 1000, 64), ObservationStore(1000, 8000, 64)
    for view in range(64):
        see(many, np.arange(1, 1001), view, view + 1)
    assert many.observation_count == 64_000
    assert (many.nbytes - few.nbytes) / (64_000 - 8_000) <= 6.0
    assert few.nbytes - 1000 * BYTES_PER_CHUNK <= 1000 * BYTES_PER_VOXEL + 100
    assert BYTES_PER_VOXEL <= 91
