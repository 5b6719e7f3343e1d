# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Voxel choice: spread over position and normal, well observed, deterministic."""

import numpy as np
import pytest

from reflest_core.surface.coverage import hemisphere_coverage
from reflest_core.surface.voxel_choice import (
    MIN_OBSERVATIONS,
    STRETCH,
    _k_centre_clusters,
    choose_voxels,
)
from test.core.surfaces import sphere_surface, without_observations


def test_the_chosen_spread_over_the_sphere_better_than_chance():
    surface = sphere_surface(voxels=2000)
    chosen = choose_voxels(surface, 25)
    assert len(set(chosen.tolist())) == 25

    def farthest_from(voxels):
        return (surface.normals @ surface.normals[voxels].T).max(axis=1).min()

    rng = np.random.default_rng(0)
    by_chance = [farthest_from(rng.choice(2000, 25, replace=False)) for _ in range(50)]
    assert farthest_from(chosen) > max(by_chance)


@pytest.mark.parametrize("points", [3, STRETCH, 5 * STRETCH + 7])
def test_clusters_are_those_of_comparing_every_point_with_every_centre(points):
    rng = np.random.default_rng(points)
    places = np.sort(rng.normal(size=(6, points)), axis=1)  # stretches in which centres are far
    places[:, points // 2] = places[:, 0]
    count = max(points // 4, 1)
    nearest, clusters = np.full(points, np.inf), np.zeros(points, int)
    centre = (places**2).sum(axis=0).argmax()
    for cluster in range(count):
        squared = ((places - places[:, centre : centre + 1]) ** 2).sum(axis=0)
        clusters[squared < nearest] = cluster
        nearest = np.minimum(nearest, squared)
        centre = nearest.argmax()
    np.testing.assert_array_equal(_k_centre_clusters(places, count), clusters)


def test_both_sides_of_a_thin_sheet_are_chosen():
    surface = sphere_surface(voxels=400)
    surface.positions[:, 2] = 0
    chosen = choose_voxels(surface, 20)
    assert 4 <= (surface.normals[chosen, 2] > 0).sum() <= 16


def test_rarely_seen_voxels_are_chosen_only_where_there_are_no_others():
    surface = sphere_surface(voxels=300, views=12)
    counts = surface.observation_counts
    assert (counts < MIN_OBSERVATIONS).any()
    assert (counts[choose_voxels(surface, 25)] >= MIN_OBSERVATIONS).all()
    few = without_observations(surface, 30)
    chosen = choose_voxels(few, 25)
    assert (few.observation_counts[chosen] > 0).all()


@pytest.mark.parametrize("count", [1, 25, 354])
def test_deterministic_and_never_more_than_asked(count):
    surface = sphere_surface()
    chosen = choose_voxels(surface, count)
    np.testing.assert_array_equal(chosen, choose_voxels(surface, count))
    often = int((surface.observation_counts >= MIN_OBSERVATIONS).sum())
    assert count > often or len(chosen) == count
    assert len(chosen) <= count


def test_no_voxels_no_choice_no_coverage():
    empty = without_observations(sphere_surface())
    chosen = choose_voxels(empty, 25)
    assert len(chosen) == 0
    assert hemisphere_coverage(empty, chosen) == 0


def test_coverage_grows_from_one_cell_to_nearly_all():
    one = sphere_surface(views=1)
    seen = np.flatnonzero(one.observation_counts)
    assert hemisphere_coverage(one, seen) == pytest.approx(1 / 32)
    many = sphere_surface(views=3000, voxels=20)
    # Voxels of the test sphere are seen up to a cosine of 0.25: the lowest ring stays empty.
    assert hemisphere_coverage(many, np.arange(20)) == pytest.approx(24 / 32, abs=0.01)
