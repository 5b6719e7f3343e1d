# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest train --model lightnet``: from scenes to calibrated weights, and what it refuses."""

import json

import numpy as np
import pytest

from reflest_core.cli.main import main
from reflest_core.models.weights import load_weights
from reflest_core.training.light.calibration import fitted_calibration
from reflest_core.training.light.measured_scans import MeasuredScans
from test.core.training.scenes import write_synbrdf

QUICK = [
    "--model",
    "lightnet",
    "--device",
    "cpu",
    "--threads",
    "1",
    "--jobs",
    "1",
    "--scans",
    "2",
    "--minibatches",
    "2",
    "--batch-size",
    "4",
    "--voxels",
    "6",
]


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """Six scenes under "sunny" light and six under "dim", three and three for validation."""
    return write_synbrdf(tmp_path_factory.mktemp("set") / "data", train=12, validation=6)


@pytest.fixture(scope="module")
def scan_folder(tmp_path_factory):
    """Shared by all runs."""
    return tmp_path_factory.mktemp("scans")


@pytest.fixture(scope="module")
def run(data, scan_folder, tmp_path_factory):
    """Train with some options; return the folder."""

    def train(*options):
        out = tmp_path_factory.mktemp("run")
        where = ["--out", str(out), "--scan-folder", str(scan_folder)]
        assert main(["train", str(data), *QUICK, *where, *options]) == 0
        return out

    return train


@pytest.fixture(scope="module")
def held_out(run):
    return run("--hold-out", "dim")


def figures(folder):
    return json.loads((folder / "held_out.json").read_text())


def test_held_out_light_is_neither_trained_on_nor_validated_by_but_measured(held_out):
    found = figures(held_out)
    assert found["recipe"]["data"]["train_looks"] == 6 * 2
    for split, scans in (("validation", 3), ("held_out", 6)):
        assert list(found["splits"][split]) == ["100", "30", "10"]
        for measured in found["splits"][split].values():
            assert measured["looks"] == scans
            assert len(measured["rmse_per_parameter"]) == 5
            per_parameter = np.square(measured["rmse_per_parameter"]).mean()
            assert measured["rmse"] == pytest.approx(np.sqrt(per_parameter))


def test_held_out_light_is_in_no_mixture_relit_scene_or_window_either(data, scan_folder, tmp_path):
    lights = ("diverse+sunny+dim", "relit+dim", "room+dim", "dim+sunny", "relit+sunny")
    other = write_synbrdf(tmp_path / "mixed", lights=lights, train=10)
    out = tmp_path / "run"
    where = ["--out", str(out), "--scan-folder", str(scan_folder), "--hold-out", "dim"]
    assert main(["train", str(data), str(other), *QUICK, *where]) == 0
    assert figures(out)["recipe"]["data"]["train_looks"] == (6 + 2) * 2


def test_ninety_percent_intervals_hold_so_many_of_the_held_out_truths(held_out):
    found = figures(held_out)
    views = found["splits"]["held_out"].values()
    held = np.mean([measured["held_by_90_percent_intervals"] for measured in views], axis=0)
    # Six scenes, each the same from 100, 30 and 10 views: the quantile of the 18 errors lies on
    # the worst scene's three equal ones, which rounding puts on either side. The three channels
    # are one kind of parameter.
    kinds = np.array([held[:3].mean(), *held[3:]])
    assert np.all((kinds > 14.9 / 18) & (kinds <= 1.0))
    _, card, _ = load_weights(held_out / "lightnet.safetensors")
    np.testing.assert_array_equal(card.calibration.factors, found["stddev_factors"])
    np.testing.assert_array_equal(card.calibration.powers, found["stddev_powers"])
    assert np.all(card.calibration.factors > 0)
    np.testing.assert_allclose(np.diag(card.calibration.correlation), 1.0)
    assert np.linalg.eigvalsh(card.calibration.correlation).min() > -1e-9
    assert card.recipe["hold_out"] == card.recipe["calibrated_under"] == ["dim"]


def test_a_training_on_everything_is_calibrated_on_what_others_held_out(run, held_out):
    other = run("--hold-out", "sunny")
    everything = run("--calibration", str(held_out), str(other))
    assert figures(everything)["recipe"]["data"]["train_looks"] == 12 * 2
    lights = figures(everything)["splits"]["held_out"]["100"]["rmse_by_light"]
    assert lights == {
        **figures(held_out)["splits"]["held_out"]["100"]["rmse_by_light"],
        **figures(other)["splits"]["held_out"]["100"]["rmse_by_light"],
    }
    _, card, _ = load_weights(everything / "lightnet.safetensors")
    joined = MeasuredScans.joined([MeasuredScans.read(held_out), MeasuredScans.read(other)])
    both = fitted_calibration(joined)
    for name in ("factors", "powers", "correlation"):
        np.testing.assert_array_equal(getattr(card.calibration, name), getattr(both, name))
    assert card.recipe["calibrated_under"] == ["dim", "sunny"]


def test_scenes_of_a_second_folder_are_trained_on_alone(data, scan_folder, run, tmp_path):
    other = write_synbrdf(tmp_path / "more", train=4)
    out = tmp_path / "run"
    where = ["--out", str(out), "--scan-folder", str(scan_folder)]
    assert main(["train", str(data), str(other), *QUICK, *where]) == 0
    assert figures(out)["recipe"]["data"]["train_looks"] == (12 + 4) * 2
    assert figures(out)["splits"]["validation"]["100"]["looks"] == 6


def test_what_it_does_without_is_in_the_card_and_in_the_measure(run):
    out = run("--without", "light", "uncertainty")
    _, card, _ = load_weights(out / "lightnet.safetensors")
    assert card.recipe["without"] == ["light", "uncertainty"]
    plain = figures(run())["splits"]["validation"]["100"]["rmse"]
    assert figures(out)["splits"]["validation"]["100"]["rmse"] != plain


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--hold-out", "noon"], "has no environment 'noon' to hold out; choose of sunny, dim"),
        (["--without", "sense"], "has no part 'sense' to do without; choose of light, fit"),
        (["--hold-out", "dim", "--calibration", "x"], "--calibration goes without --hold-out"),
        (["--loss", "rmse1"], "--loss goes with --model hemicnn or grouplet"),
        (["--jobs", "-1"], "--jobs is -1, but must be 1 or more"),
        (["--scans", "0"], "--scans is 0, but must be 1 or more"),
        (["--views", "5", "10"], "--views goes with --model hemicnn or grouplet"),
    ],
)
def test_what_cannot_be_is_refused(data, scan_folder, tmp_path, capsys, options, message):
    where = ["--out", str(tmp_path), "--scan-folder", str(scan_folder)]
    assert main(["train", str(data), *QUICK, *where, *options]) == 2
    assert message in capsys.readouterr().err


def test_a_calibration_that_is_none_is_refused(data, run, tmp_path, capsys):
    given = ["--out", str(tmp_path), "--calibration", str(run())]
    assert main(["train", str(data), *QUICK, *given]) == 2
    assert "has no held_out.npz: it is no finished training" in capsys.readouterr().err


def test_other_networks_have_none_of_its_options(data, tmp_path, capsys):
    command = ["train", str(data), "--model", "hemicnn", "--out", str(tmp_path)]
    assert main([*command, "--hold-out", "dim"]) == 2
    assert "--hold-out goes with --model lightnet" in capsys.readouterr().err
