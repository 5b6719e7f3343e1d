# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Full voxels keep observations whose directions are spread."""

import hypothesis.strategies as st
import numpy as np
from hypothesis import given

from reflest_core.fusion.observations.observation_replacement import closest_pair
from reflest_core.fusion.observations.observation_store import ObservationStore

SLOTS = 6
POSITION = np.zeros((1, 3), np.float32)
NORMAL = np.array([[0, 0, 1]], np.float32)
angle = st.floats(0.0, 1.5, width=32)
centre_on_sphere = st.tuples(angle, st.floats(0.0, 6.0, width=32)).map(
    lambda tp: (np.sin(tp[0]) * np.cos(tp[1]), np.sin(tp[0]) * np.sin(tp[1]), np.cos(tp[0]))
)


def store_with_one_voxel():
    store = ObservationStore(4, 4, SLOTS)
    return store, store.claim(np.array([77]), np.array([-1]), POSITION, NORMAL, 1)


def kept_directions(store, centres):
    _, ids = store.observations(np.array([0]))
    directions = centres[ids].astype(np.float64)
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def least_squared_chord(directions):
    gaps = np.sum((directions[:, None] - directions[None]) ** 2, axis=-1)
    return gaps[np.triu_indices(len(directions), 1)].min()


@given(st.lists(centre_on_sphere, min_size=SLOTS + 1, max_size=30))
def test_least_angle_never_shrinks_and_count_is_bounded(points):
    centres = np.array(points, np.float32)
    store, row = store_with_one_voxel()
    spread = None
    for view in range(len(centres)):
        kept = store.observe(row, np.array([[view, 0, 0]], np.uint8), view, centres)
        assert store.rows.counts[0] == min(view + 1, SLOTS) or kept == 0
        colours, ids = store.observations(np.array([0]))
        assert len(set(ids)) == len(ids)
        assert colours[:, 0].tolist() == ids.tolist()
        if view >= SLOTS - 1:
            now = least_squared_chord(kept_directions(store, centres))
            assert spread is None or now >= spread * (1.0 - 1e-12)
            spread = now


def test_new_direction_replaces_one_of_the_closest_pair():
    degrees = np.array([0, 20, 40, 60, 61, 80, -25, 60.5])
    centres = np.zeros((8, 3), np.float32)
    centres[:, 0], centres[:, 2] = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    store, row = store_with_one_voxel()
    kept = [store.observe(row, np.zeros((1, 3), np.uint8), n, centres) for n in range(8)]
    assert kept == [1, 1, 1, 1, 1, 1, 1, 0]
    assert sorted(store.observations(np.array([0]))[1].tolist()) == [0, 1, 2, 3, 5, 6]


@given(st.lists(centre_on_sphere, min_size=2, max_size=12))
def test_closest_pair_is_the_closest(points):
    directions = np.array(points).T.copy()
    m, n = closest_pair(directions, len(points))
    gaps = np.sum((directions[:, :, None] - directions[:, None, :]) ** 2, axis=0)
    assert m < n
    assert gaps[m, n] == gaps[np.triu_indices(len(points), 1)].min()
