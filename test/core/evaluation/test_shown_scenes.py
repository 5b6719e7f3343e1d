# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An estimate knows what the shown views saw, of the surface and of the light, and no more."""

import dataclasses

import numpy as np
import pytest

from reflest_core.evaluation.shown_scenes import load_shown, random_subset, shown
from reflest_core.evaluation.studies.view_study import few_views
from reflest_core.training.data.sample import TrainingError
from test.synbrdf.realism.sparse_scenes import ball_scene


def test_all_views_give_the_whole_surface_and_its_light():
    scene = ball_scene()
    sample = shown(scene)
    np.testing.assert_array_equal(sample.surface.colours, scene.surface.colours)
    assert sample.surface.light.seen_share > 0.1
    assert sample.ward.tolist() == [0.9, 0.5, 0.3, 0.0, 0.1]
    assert (sample.environment, sample.index) == ("smooth", 3)


def test_views_that_are_not_shown_change_nothing():
    scene = ball_scene()
    views = np.array([2, 5, 11])
    hidden = np.setdiff1d(np.arange(30), views)
    images = scene.thumbnails.rgbe.copy()
    images[hidden] = 255 - images[hidden]
    is_hidden = np.isin(scene.surface.view_indices, hidden)
    colours = scene.surface.colours.copy()
    colours[is_hidden] = 255 - colours[is_hidden]
    other = dataclasses.replace(
        scene,
        surface=dataclasses.replace(scene.surface, colours=colours),
        thumbnails=dataclasses.replace(scene.thumbnails, rgbe=images),
    )
    one, two = shown(scene, views).surface, shown(other, views).surface
    np.testing.assert_array_equal(one.colours, two.colours)
    np.testing.assert_array_equal(one.light.radiance, two.light.radiance)
    assert set(one.view_indices.tolist()) <= set(views.tolist())
    assert one.light.seen_share < shown(scene).surface.light.seen_share


def test_fewer_views_are_some_of_more():
    scene = ball_scene()
    (five,), (ten,) = few_views([scene], 5), few_views([scene], 10)
    fewer, more = (set(look.surface.view_indices.tolist()) for look in (five, ten))
    assert fewer < more
    assert len(fewer) <= 5
    assert np.all(five.surface.light.coverage <= ten.surface.light.coverage)


def test_a_subset_is_drawn_by_seed_and_stays_in_order():
    scenes = [dataclasses.replace(ball_scene(views=6), index=k) for k in range(12)]
    drawn = [scene.index for scene in random_subset(scenes, 5, 3)]
    assert drawn == [scene.index for scene in random_subset(scenes, 5, 3)]
    assert drawn == sorted(drawn)
    assert drawn != [scene.index for scene in random_subset(scenes, 5, 4)]
    assert len(random_subset(scenes, 50, 3)) == 12


def test_a_split_without_scenes_is_named(data):
    assert len(load_shown(data, "validation", limit=2)) == 2
    with pytest.raises(TrainingError, match="no scenes of split 'test'"):
        load_shown(data, "test")
