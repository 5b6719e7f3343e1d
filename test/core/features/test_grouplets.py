"""Grouplets: what a branch holds, its order, sampling without replacement, repeatability."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.features.grouplets import BRANCHES, NODES_PER_VOXEL, _draw_one, draw_grouplets
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


@given(st.integers(BRANCHES, 200), st.lists(st.floats(0, 1, exclude_max=True), min_size=5))
def test_drawing_never_repeats_where_there_are_enough(count, uniforms):
    taken = np.empty(BRANCHES, np.int64)
    for k in range(BRANCHES):
        taken[k] = _draw_one(uniforms[k], count, taken[:k])
    assert len(set(taken)) == BRANCHES
    assert taken.min() >= 0
    assert taken.max() < count
