# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Shading of a data set on disk: whole, resumed, the same each time, the truth beside it."""

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.features.light.shading import OBSERVATIONS
from reflest_core.models.lightnet import VOXELS
from reflest_core.synbrdf.generate import generate
from reflest_core.synbrdf.generation import Generation
from reflest_core.synbrdf.process_pool import process_pool
from reflest_core.synbrdf.scene_file import load_scenes, sha256
from reflest_core.training.light.shaded_scene import SceneDraw, shaded, training_draw
from reflest_core.training.light.shading_shards import (
    HELD_OUT_VIEWS,
    load_shadings,
    make_shadings,
)
from reflest_core.training.sample import TrainingError


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("set") / "data"
    scenes = {"train": 2, "validation": 1, "unseen": 0}
    generate(folder, Generation(5, scenes, points=60, views=12, samples=4), process_pool(1))
    return folder


def test_looks_come_back_with_their_truth_and_a_lost_file_is_made_again(data, tmp_path):
    make_shadings(data, tmp_path, "train", looks=3, jobs=1)
    looks = load_shadings([tmp_path], "train")
    assert len(looks) == 6
    assert looks.scene.tolist() == [0, 0, 0, 1, 1, 1]
    assert looks.arrays["apparent"].shape == (6, VOXELS, OBSERVATIONS, 3)
    for scene in load_scenes(data, "train"):
        truth = [*scene.truth.rho_d, scene.truth.rho_s, scene.truth.alpha]
        np.testing.assert_allclose(looks.ward[looks.scene == scene.index], [truth] * 3, rtol=1e-6)
    (shard,) = tmp_path.glob("train-*")
    before = {name: array.copy() for name, array in looks.arrays.items()}
    shard.unlink()
    make_shadings(data, tmp_path, "train", looks=3, jobs=1)
    for name, array in load_shadings([tmp_path], "train").arrays.items():
        np.testing.assert_array_equal(array, before[name])


def test_what_is_there_is_left_alone(data, tmp_path):
    make_shadings(data, tmp_path, "validation", looks=1, jobs=1)
    looks = load_shadings([tmp_path], "validation")
    assert looks.views.tolist() == list(HELD_OUT_VIEWS)
    (shard,) = tmp_path.glob("validation-*")
    written, digest = shard.stat().st_mtime_ns, sha256(shard)
    make_shadings(data, tmp_path, "validation", looks=1, jobs=1)
    assert (shard.stat().st_mtime_ns, sha256(shard)) == (written, digest)


def test_a_split_that_is_not_there_is_named(data, tmp_path):
    with pytest.raises(TrainingError, match="unseen"):
        make_shadings(data, tmp_path, "unseen", looks=1, jobs=1)
    with pytest.raises(TrainingError, match="train"):
        load_shadings([tmp_path], "train")


def test_fewer_views_know_less_of_the_light(data):
    scene = next(load_scenes(data, "train"))
    few, many = (shaded(scene, SceneDraw(views), np.random.default_rng(0)) for views in (2, 12))
    assert few.zones[:, 3].mean() < many.zones[:, 3].mean()
    assert few.is_seen.sum() < many.is_seen.sum()


def test_a_longer_exposure_cancels_out_where_nothing_clips(data):
    """Apparent albedo is a ratio to the light seen by the same camera."""
    scene = next(load_scenes(data, "train"))
    short, long = (
        shaded(scene, SceneDraw(12, exposure), np.random.default_rng(0)) for exposure in (0.1, 0.15)
    )
    both = short.is_seen & long.is_seen & (long.clipped.max(axis=-1) == 0)
    ratio = long.apparent[both].mean() / short.apparent[both].mean()
    assert ratio == pytest.approx(1.0, abs=0.15)


def test_training_looks_differ_in_views_exposure_and_faults():
    draws = [training_draw(np.random.default_rng(seed)) for seed in range(200)]
    views = np.array([draw.views for draw in draws])
    assert views.min() < 10
    assert views.max() <= 100
    assert 0.3 < np.mean([draw.realism is not None for draw in draws]) < 0.7
    assert np.std(np.log([draw.exposure for draw in draws])) == pytest.approx(0.25, abs=0.05)
