# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Simulated scans of a data set on disk: whole, resumed, always the same, with their truth."""

import dataclasses

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.models.lightnet import VOXELS
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.generation.generate import generate
from reflest_core.synbrdf.generation.process_pool import process_pool
from reflest_core.synbrdf.scenes.scene_file import load_scenes, sha256, shard_bytes
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light import scan_plan
from reflest_core.training.light.scan_plan import MEASURED_VIEWS, ScanPlan
from reflest_core.training.light.scan_shards import make_scans
from reflest_core.training.light.simulated_scan import ScanDraw, simulated_scan, training_draw
from reflest_core.training.light.stored_scans import load_scans


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("set") / "data"
    scenes = {"train": 2, "validation": 1, "unseen": 0}
    generate(folder, Generation(5, scenes, points=60, views=12, samples=4), process_pool(1))
    return folder


TRAIN = ScanPlan("train", varied=3)


def test_scans_come_back_with_their_truth_and_a_lost_file_is_made_again(data, tmp_path):
    scans = load_scans(make_scans(data, TRAIN, tmp_path, jobs=1))
    assert len(scans) == 6
    assert scans.scene.tolist() == [0, 0, 0, 1, 1, 1]
    assert scans.arrays["apparent"].shape[:2] == (6, VOXELS)
    for scene in load_scenes(data, "train"):
        ward = scene.materials.dominant.ward
        truth = [*ward.rho_d, ward.rho_s, ward.alpha]
        np.testing.assert_allclose(scans.ward[scans.scene == scene.index], [truth] * 3, rtol=1e-6)
    before = {name: array.copy() for name, array in scans.arrays.items()}
    (shard,) = tmp_path.rglob("train-*.safetensors")
    shard.unlink()
    again = load_scans(make_scans(data, TRAIN, tmp_path, jobs=1))
    for name, array in again.arrays.items():
        np.testing.assert_array_equal(array, before[name])


def test_what_is_there_is_left_alone(data, tmp_path):
    plan = ScanPlan("validation")
    (shard,) = make_scans(data, plan, tmp_path, jobs=1)
    assert load_scans([shard]).views.tolist() == list(MEASURED_VIEWS)
    written, digest = shard.stat().st_mtime_ns, sha256(shard)
    make_scans(data, plan, tmp_path, jobs=1)
    assert (shard.stat().st_mtime_ns, sha256(shard)) == (written, digest)


def test_scans_of_other_code_or_other_scenes_are_refused(data, tmp_path, monkeypatch):
    out = tmp_path / "scans"
    make_scans(data, TRAIN, out, jobs=1)
    with monkeypatch.context() as patch:
        patch.setattr(scan_plan, "source_fingerprint", lambda *modules: "of other code")
        with pytest.raises(TrainingError, match="made by other code, with other settings"):
            make_scans(data, TRAIN, out, jobs=1)
    other = tmp_path / data.name
    other.mkdir()
    scenes = list(load_scenes(data, "train"))
    (other / "train-00000.safetensors").write_bytes(shard_bytes(scenes[:1]))
    with pytest.raises(TrainingError, match="of other scenes; delete"):
        make_scans(other, TRAIN, out, jobs=1)


def test_a_damaged_scan_is_named(data, tmp_path):
    (shard,) = make_scans(data, TRAIN, tmp_path, jobs=1)
    shard.write_bytes(b"not safetensors")
    with pytest.raises(TrainingError, match=rf"{shard.name} is damaged"):
        make_scans(data, TRAIN, tmp_path, jobs=1)


def test_only_scans_under_the_chosen_light_are_made_and_loaded(data, tmp_path):
    scenes = list(load_scenes(data, "train"))
    chosen = scenes[1].environment
    assert scenes[0].environment != chosen
    held_out = load_scans(make_scans(data, ScanPlan("train", only=(chosen,)), tmp_path, 1))
    assert set(held_out.environment) == {chosen}
    paths = make_scans(data, TRAIN, tmp_path, jobs=1)
    rest = load_scans(paths, lambda card: card.environment != chosen)
    assert rest.scene.tolist() == [0, 0, 0]
    with pytest.raises(TrainingError, match="no scene to scan"):
        load_scans(paths, lambda card: False)


@pytest.mark.parametrize("part", ["completion", "visibility"])
def test_a_part_of_scan_can_be_left_out(data, tmp_path, part):
    whole, seen = (
        load_scans(make_scans(data, plan, tmp_path, jobs=1))
        for plan in (TRAIN, dataclasses.replace(TRAIN, without=(part,)))
    )
    np.testing.assert_array_equal(whole.arrays["cosine"], seen.arrays["cosine"])
    assert np.any(whole.arrays["diffuse_light"] != seen.arrays["diffuse_light"])


def test_a_split_that_is_not_there_is_named(data, tmp_path):
    with pytest.raises(TrainingError, match="unseen"):
        make_scans(data, ScanPlan("unseen"), tmp_path, jobs=1)


def test_fewer_views_know_less_of_the_light(data):
    scene = next(load_scenes(data, "train"))
    few, many = (
        simulated_scan(scene, ScanDraw(views), np.random.default_rng(0)) for views in (2, 12)
    )
    assert few.zones[:, 3].mean() < many.zones[:, 3].mean()
    assert few.is_seen.sum() < many.is_seen.sum()


def test_views_from_below_may_show_the_light_alone(data):
    scene = next(load_scenes(data, "train"))
    from_object = scene.surface.view_centres - scene.surface.positions.mean(axis=0)
    elevations = np.degrees(np.arcsin(from_object[:, 2] / np.linalg.norm(from_object, axis=1)))
    middle, highest = float(np.median(elevations)), float(elevations.max())
    every, half, none = (
        simulated_scan(scene, ScanDraw(12, above=above), np.random.default_rng(0))
        for above in (None, middle, highest)
    )
    np.testing.assert_array_equal(half.zones[:, 3], every.zones[:, 3])
    assert half.is_seen.sum() < every.is_seen.sum()
    np.testing.assert_array_equal(none.apparent, every.apparent)  # too few to part with


def test_a_room_may_be_known_beyond_the_views(data):
    scene = next(load_scenes(data, "train"))
    few, knowing, every = (
        simulated_scan(scene, ScanDraw(views, knows_room=knows), np.random.default_rng(0))
        for views, knows in ((5, False), (5, True), (12, False))
    )
    assert knowing.zones[:, 3].sum() > few.zones[:, 3].sum()
    np.testing.assert_allclose(knowing.zones[:, 3], every.zones[:, 3], atol=1e-6)
    np.testing.assert_array_equal(knowing.is_seen, few.is_seen)


def test_a_longer_exposure_cancels_out_where_nothing_clips(data):
    """Apparent albedo is a ratio to the light seen by the same camera."""
    scene = next(load_scenes(data, "train"))
    short, long = (
        simulated_scan(scene, ScanDraw(12, exposure), np.random.default_rng(0))
        for exposure in (0.1, 0.15)
    )
    both = short.is_seen & long.is_seen & (long.clipped.max(axis=-1) == 0)
    ratio = long.apparent[both].mean() / short.apparent[both].mean()
    assert ratio == pytest.approx(1.0, abs=0.15)


def test_training_scans_differ_in_views_exposure_and_faults():
    draws = [training_draw(np.random.default_rng(seed)) for seed in range(200)]
    views = np.array([draw.views for draw in draws])
    assert views.min() < 10
    assert views.max() <= 100
    assert 0.3 < np.mean([draw.realism is not None for draw in draws]) < 0.7
    assert 0.8 < np.mean([draw.sees_light for draw in draws]) < 1.0
    assert 0.08 < np.mean([draw.knows_room for draw in draws]) < 0.25
    assert 0.25 < np.mean([draw.above is not None for draw in draws]) < 0.55
    assert np.std(np.log([draw.exposure for draw in draws])) == pytest.approx(0.25, abs=0.05)
