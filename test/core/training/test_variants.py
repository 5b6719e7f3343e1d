# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The seven variants of Table 2, and the command that trains them."""

import numpy as np
import pytest

from reflest_core.cli.main import main
from reflest_core.models.weights import load_weights
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.training.data.sample import Degradation, load_samples
from reflest_core.training.variants import VARIANTS, variant_named
from test.core.training.scenes import write_synbrdf

QUICK = [
    "--device",
    "cpu",
    "--threads",
    "1",
    "--minibatches",
    "3",
    "--batch-size",
    "2",
    "--voxels",
    "4",
    "--nodes-per-voxel",
    "2",
]


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    return write_synbrdf(tmp_path_factory.mktemp("data"), train=8, validation=3)


def test_the_seven_are_those_of_table_2():
    what = [(v.network, v.loss, v.colour_constancy > 0) for v in VARIANTS]
    assert what == [
        ("grouplet", "rmse1", True),
        ("grouplet", "rmse1", False),
        ("hemicnn", "rmse2", False),
        ("hemicnn", "cuberoot", False),
        ("hemicnn", "rmse1", False),
        ("hemicnn", "cuberoot", True),
        ("grouplet", "rmse2", False),
    ]
    assert variant_named("grouplet-rmse1-ec").colour_constancy == 0.01
    assert len({variant.file_name for variant in VARIANTS}) == 7


def test_all_variants_are_trained_one_after_another(tmp_path, data, capsys):
    assert main(["train", str(data), "--all", "--out", str(tmp_path), *QUICK]) == 0
    limits = {"hemicnn": 60_000, "grouplet": 340_000}
    digests = set()
    for variant in VARIANTS:
        path = tmp_path / variant.name / variant.file_name
        assert path.stat().st_size < limits[variant.network]
        _, card, digest = load_weights(path)
        digests.add(digest)
        assert card.network == variant.network
        assert card.recipe["loss"] == variant.loss
        assert card.recipe["colour_constancy"] == variant.colour_constancy
        assert card.recipe["data"]["train"] == 8
    # Of one network, every loss leads from the same start to other weights.
    assert len(digests) == 7
    assert capsys.readouterr().out.count("weights: ") == 7


def test_one_variant_follows_its_recipe_but_for_what_is_given(tmp_path, data):
    variant = variant_named("hemicnn-cuberoot-ec")
    out = ["--variant", variant.name, "--out", str(tmp_path)]
    drawn = ["--views", "7", "30", "--candidates", "20"]
    assert main(["train", str(data), *out, *QUICK, *drawn]) == 0
    _, card, _ = load_weights(tmp_path / variant.file_name)
    assert card.recipe["augmentation"]["views"] == [7, 30]
    assert card.recipe["augmentation"]["candidates"] == 20
    assert card.recipe["minibatches"] == 3
    assert card.recipe["optimiser"] == variant.recipe().optimiser


def test_realism_shows_every_scene_a_second_time(tmp_path, data):
    out = ["--model", "hemicnn", "--out", str(tmp_path), "--realism", "sensor", "pose"]
    assert main(["train", str(data), *out, *QUICK]) == 0
    _, card, _ = load_weights(tmp_path / "hemicnn.safetensors")
    assert card.recipe["data"] == {
        "seed": 7,
        "train": 8,
        "validation": 3,
        "realism": ["sensor", "pose"],
    }
    clean = load_samples(data, "train")
    degradation = Degradation(Realism.only([Effect.SENSOR]), seed=1)
    first, again = (load_samples(data, "train", degradation) for _ in range(2))
    assert len(first) == len(clean) == 8
    for one, same, without in zip(first, again, clean, strict=True):
        np.testing.assert_array_equal(one.surface.colours, same.surface.colours)
        assert (one.surface.colours != without.surface.colours).any()
        np.testing.assert_array_equal(one.ward, without.ward)


def test_a_damaged_description_of_packed_scenes_is_one_sentence(tmp_path, capsys):
    (tmp_path / "packed.json").write_text("{")
    assert main(["train", str(tmp_path), "--model", "hemicnn", "--out", str(tmp_path / "run")]) == 2
    assert "packed.json is damaged" in capsys.readouterr().err


def test_packed_scenes_train_to_the_same_weights(tmp_path, data):
    packed = ["--out", str(tmp_path / "packed")]
    assert main(["train", str(data), "--pack", *packed]) == 0
    for folder in (data, tmp_path / "packed"):
        out = ["--model", "hemicnn", "--out", str(tmp_path / f"from-{folder.name}")]
        assert main(["train", str(folder), *out, *QUICK]) == 0
    _, card, digest = load_weights(tmp_path / f"from-{data.name}" / "hemicnn.safetensors")
    _, _, again = load_weights(tmp_path / "from-packed" / "hemicnn.safetensors")
    assert card.recipe["data"]["train"] == 8
    assert again == digest


def test_an_unknown_variant_and_a_changed_loss_are_refused(tmp_path, data, capsys):
    out = ["--out", str(tmp_path), *QUICK]
    assert main(["train", str(data), "--variant", "grouplet-rmse3", *out]) == 2
    assert (
        "there is no variant 'grouplet-rmse3'; choose one of grouplet-" in capsys.readouterr().err
    )
    assert main(["train", str(data), "--all", "--loss", "rmse2", *out]) == 2
    assert "--loss and --lambda go with --model" in capsys.readouterr().err
