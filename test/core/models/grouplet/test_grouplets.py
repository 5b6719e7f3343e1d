# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Grouplets: what a branch holds, its order, sampling without replacement, repeatability."""

import dataclasses

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.models.grouplet.grouplets import (
    BRANCHES,
    DRAWN_FROM,
    NODES_PER_VOXEL,
    draw_grouplets,
    draw_without_repeats,
    shuffled_slots,
)
from test.core.surfaces import sphere_surface

SURFACE = sphere_surface()
VOXELS = np.flatnonzero(SURFACE.observation_counts >= BRANCHES)[:20]


def test_every_branch_is_an_observation_of_its_voxel_with_its_views_statistics():
    drawn = draw_grouplets(SURFACE, VOXELS, seed=1)
    assert drawn.branches.shape == (20 * NODES_PER_VOXEL, BRANCHES, 12)
    directions = SURFACE.view_directions()
    for node in range(0, len(drawn.branches), 7):
        voxel = VOXELS[node // NODES_PER_VOXEL]
        rows = slice(SURFACE.offsets[voxel], SURFACE.offsets[voxel + 1])
        views = SURFACE.view_indices[rows]
        known = np.concatenate(
            [
                SURFACE.colours[rows] / 255,
                directions[rows],
                SURFACE.view_foreground[views] / 255,
                SURFACE.view_background[views] / 255,
            ],
            axis=1,
        )
        distance = np.abs(drawn.branches[node][:, None] - known[None]).max(axis=2)
        assert (distance.min(axis=1) < 1e-5).all()
        assert len(set(distance.argmin(axis=1))) == BRANCHES
        np.testing.assert_array_equal(drawn.normals[node], SURFACE.normals[voxel])


def test_branches_are_sorted_by_falling_cosine():
    drawn = draw_grouplets(SURFACE, VOXELS, seed=1)
    cosines = np.einsum("gmk,gk->gm", drawn.branches[:, :, 3:6], drawn.normals)
    assert (np.diff(cosines, axis=1) <= 1e-6).all()


def test_the_seed_decides():
    first, again, other = (draw_grouplets(SURFACE, VOXELS, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.branches, again.branches)
    assert (first.branches != other.branches).any()


def test_an_unknown_background_enters_as_zero():
    surface = sphere_surface()
    surface.view_background[:] = np.nan
    assert not draw_grouplets(surface, VOXELS, seed=1).branches[:, :, 9:].any()


def test_every_observation_is_held_once_and_every_one_held_is_drawn():
    drawn = draw_grouplets(SURFACE, VOXELS, seed=1)
    held = drawn.observations
    assert len(np.unique(held, axis=0)) == len(held)
    assert set(drawn.members.ravel()) == set(range(len(held)))
    assert len(held) < drawn.members.size


def test_a_voxel_seen_less_often_than_a_node_has_branches_repeats_its_observations():
    voxels = np.flatnonzero(
        (SURFACE.observation_counts > 0) & (SURFACE.observation_counts < BRANCHES)
    )
    assert len(voxels)
    drawn = draw_grouplets(SURFACE, voxels, seed=1)
    assert drawn.members.shape == (len(voxels) * NODES_PER_VOXEL, BRANCHES)
    assert len(drawn.observations) <= SURFACE.observation_counts[voxels].sum()


def test_nodes_share_observations_of_an_often_seen_voxel_and_each_is_as_likely():
    surface = sphere_surface(voxels=20, views=200)
    voxel = np.array([int(np.argmax(surface.observation_counts))])
    count = int(surface.observation_counts[voxel[0]])
    assert count > 2 * DRAWN_FROM
    colours = np.zeros_like(surface.colours)
    colours[surface.offsets[voxel[0]] :][:count, 0] = np.arange(count)
    surface = dataclasses.replace(surface, colours=colours)
    drawn = np.zeros(count)
    seeds = 2000
    for seed in range(seeds):
        observations = draw_grouplets(surface, voxel, seed).observations
        assert len(observations) <= DRAWN_FROM
        drawn[np.rint(observations[:, 0] * 255).astype(int)] += 1
    likely = drawn.sum() / seeds / count
    spread = np.sqrt(seeds * likely * (1 - likely))
    assert np.abs(drawn - seeds * likely).max() < 5 * spread


@given(st.integers(0, 60), st.lists(st.floats(0, 1, exclude_max=True), max_size=30))
def test_shuffled_slots_are_distinct_and_as_many_as_asked(count, uniform):
    slots = shuffled_slots(np.array(uniform), count)
    assert len(set(slots.tolist())) == len(slots) == min(count, len(uniform))
    assert ((slots >= 0) & (slots < count)).all()


@given(
    st.integers(BRANCHES, 200),
    st.lists(st.floats(0, 1, exclude_max=True), min_size=BRANCHES, max_size=BRANCHES),
)
def test_drawing_never_repeats_where_there_are_enough(count, uniforms):
    drawn = np.empty(BRANCHES, np.int32)
    draw_without_repeats(np.array(uniforms), count, drawn)
    # The rule in words: the k-th is the floor(u (count - k))-th of those not taken yet.
    left = list(range(count))
    assert drawn.tolist() == [left.pop(int(u * len(left))) for u in uniforms]
