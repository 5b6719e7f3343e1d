# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Materials of scanned scenes: features of what was found, truths of what stood there."""

import json
import shutil
import zlib
from pathlib import Path

import numpy as np
import pytest

from reflest_core.cli.main import main
from reflest_core.models.weights import load_weights
from reflest_core.training.light.data import ONE_HELD_OUT_OF
from reflest_core.training.light.scan_file import read_arrays, read_cards
from reflest_core.training.light.scanned_materials import SHARES, scan_scenes

TABLE = Path(__file__).parents[4] / "captures" / "table"


def light_named(is_held_out):
    """A light's name that is, or is not, held out."""
    names = (f"light-{number}" for number in range(1000))
    return next(
        name for name in names if (zlib.crc32(name.encode()) % ONE_HELD_OUT_OF == 0) == is_held_out
    )


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    """The shipped scan twice, under a light that is trained on and one that is held out."""
    folder = tmp_path_factory.mktemp("scenes") / "tables"
    for name, light in (("one", light_named(False)), ("other", light_named(True))):
        shutil.copytree(TABLE, folder / name)
        truth = json.loads((folder / name / "truth.json").read_text())
        (folder / name / "truth.json").write_text(json.dumps(truth | {"environment": light}))
    return folder


@pytest.fixture(scope="module")
def scans(tmp_path_factory):
    """Where what is learned from is kept."""
    return tmp_path_factory.mktemp("scans")


@pytest.fixture(scope="module")
def paths(tables, scans):
    return scan_scenes(tables, scans, 1)


def test_each_scene_gives_the_materials_that_are_found_in_it_with_their_truth(tables, paths):
    card = json.loads((tables / "one" / "truth.json").read_text())
    true = {(one["rho_s"], one["alpha"]): one for one in card["materials"]}
    found = read_cards(paths[0])
    frames = sorted({one.views for one in found})
    assert frames == [round(share * max(frames)) for share in SHARES]
    for views in frames:
        parts = set()
        for one in found:
            gloss = min(true, key=lambda pair, ward=one.ward: abs(pair[1] - ward[4]))
            assert one.ward[3:] == pytest.approx(gloss, abs=1e-6)
            if one.views == views:
                parts.add(true[gloss]["part"])
        assert len(parts) >= 4  # the table and three objects


def test_true_albedos_are_those_of_the_material_that_most_voxels_are_of(tables, paths):
    card = json.loads((tables / "one" / "truth.json").read_text())
    for one in read_cards(paths[0]):
        (same,) = [true for true in card["materials"] if abs(true["alpha"] - one.ward[4]) < 1e-6]
        assert one.ward[:3] == pytest.approx(same["rho_d_mean"], abs=0.1)


def test_features_are_those_of_the_joint_light(paths):
    arrays = read_arrays(paths[0])
    assert all(np.isfinite(array).all() for array in arrays.values())
    truth = np.array([one.ward for one in read_cards(paths[0])])
    # The first of the physics' answers to rho_d: the joint light's.
    ratio = arrays["found_albedo"][:, :, 0] / truth[:, :3]
    assert 0.6 < np.median(ratio) < 1.6


def test_scenes_are_scanned_once(tables, scans, paths):
    before = [path.stat().st_mtime_ns for path in paths]
    assert scan_scenes(tables, scans, 1) == paths
    assert [path.stat().st_mtime_ns for path in paths] == before


def test_training_holds_a_tenth_of_the_lights_out_and_calibrates_on_it(
    tables, scans, paths, tmp_path
):
    out = tmp_path / "run"
    command = ["train", str(tables), "--model", "lightnet", "--recipe", "scenes"]
    command += ["--scan-folder", str(scans), "--out", str(out), "--device", "cpu", "--jobs", "1"]
    assert main([*command, "--minibatches", "2", "--batch-size", "4", "--threads", "1"]) == 0
    _, card, _ = load_weights(out / "lightnet.safetensors")
    assert card.recipe["calibrated_under"] == [light_named(True)]
    described = card.recipe["data"]
    assert described["scenes"] == 2
    assert described["train_looks"] == len(read_cards(paths[0]))
    assert described["held_out_looks"] == len(read_cards(paths[1]))


def test_a_folder_without_scenes_is_refused_in_a_sentence(tmp_path, capsys):
    command = ["train", str(tmp_path), "--model", "lightnet", "--recipe", "scenes"]
    assert main([*command, "--out", str(tmp_path / "run"), "--device", "cpu"]) != 0
    assert "no scanned scene with a truth.ply" in capsys.readouterr().err


@pytest.mark.parametrize(
    "what", [["--model", "grouplet"], ["--variant", "hemicnn-rmse1"], ["--all"]]
)
def test_other_networks_have_no_recipe_for_scenes(what, tables, tmp_path, capsys):
    assert main(["train", str(tables), *what, "--recipe", "scenes", "--out", str(tmp_path)]) != 0
    assert "has no recipe 'scenes': give --recipe" in capsys.readouterr().err
