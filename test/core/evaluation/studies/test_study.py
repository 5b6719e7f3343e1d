# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest evaluate`` measures every part into a record of its own."""

import numpy as np
import pytest

from reflest_core.cli import evaluate
from reflest_core.cli.main import main
from reflest_core.evaluation import parts
from reflest_core.evaluation.paper_figures import TABLES_2_AND_3
from reflest_core.evaluation.statistics.bootstrap import mean_of_roots_over_groups
from reflest_core.models.predictor import Predictor
from reflest_core.training.data.sample import load_samples
from test.core.evaluation.conftest import TRAINED
from test.core.evaluation.results import read, rows_of

MEASURED = (*TRAINED, "lightnet")


def test_the_command_knows_every_part():
    assert tuple(parts.PARTS) == evaluate.ALL_PARTS


def test_table_2_holds_what_the_network_reaches(out, runs, data):
    rows = read(out, "table-2")["rows"]
    assert {(row["variant"], row["split"]) for row in rows} == {
        (name, split) for name in MEASURED for split in ("validation", "unseen")
    }
    row = next(r for r in rows if (r["variant"], r["split"]) == ("hemicnn-rmse2", "validation"))
    predictor = Predictor("hemicnn", runs / "hemicnn-rmse2" / "hemicnn-rmse2.safetensors")
    samples = load_samples(data, "validation")
    statistics = predictor.card.statistics["ward"]
    estimates = read(out, "estimates")["validation"]
    made = np.array(estimates["networks"]["hemicnn-rmse2"]["ward"])
    np.testing.assert_allclose(estimates["truths"], [s.ward for s in samples])
    errors = (made - np.stack([s.ward for s in samples])) / statistics.stddev
    assert row["accuracy"]["ward"]["overall"] == pytest.approx(
        np.sqrt((errors**2).mean()), abs=1e-4
    )
    interval = row["accuracy"]["over_scenes"]
    assert interval["low"] < row["accuracy"]["ward"]["overall"] < interval["high"]
    of_mean = mean_of_roots_over_groups(errors**2, [s.environment for s in samples])
    assert row["accuracy"]["mean_over_environments"] == pytest.approx(vars(of_mean), abs=1e-4)
    assert row["accuracy"]["environments"] == 2
    assert row["paper_rmse"] == 0.564
    assert row["paper_rank"] == 3
    assert row["model_id"] == predictor.model_id


def test_the_breakdown_adds_up_to_table_2(out):
    for row in read(out, "table-2")["rows"]:
        found, overall = row["breakdown"], row["accuracy"]["ward"]["overall"]
        assert sum(found["parameter_shares"]) == pytest.approx(1)
        lights = found["environments"]
        squared = sum(light["scenes"] * light["rmse"] ** 2 for light in lights)
        assert squared / row["accuracy"]["scenes"] == pytest.approx(overall**2)
        assert lights == sorted(lights, key=lambda light: light["rmse"])
        spans = [fifth["rho_s"] for fifth in found["fifths"]]
        assert spans == sorted(spans)
    shares = rows_of(out, "Breakdown of the errors", "variant")
    validation = [row for row in read(out, "table-2")["rows"] if row["split"] == "validation"]
    for shown, row in zip(shares, validation, strict=False):
        assert [cell for _, cell in shown] == [
            row["title"],
            *(f"{100 * share:.0f} %" for share in row["breakdown"]["parameter_shares"]),
        ]


def test_training_with_faults_is_compared_with_training_without(out):
    record = read(out, "realism-training")
    (row,) = record["rows"]
    assert row["network"] == "HemiCNN, RMSE_1"
    assert row["recipe"]["data"]["realism"] == "all"
    of_all = {one["effect"]: one["rmse"]["hemicnn-rmse1"] for one in read(out, "realism")["rows"]}
    assert row["with"] == {"clean": of_all["none"], "faults": of_all["all"]}
    assert row["with"]["clean"] != row["without"]["clean"]
    (shown,) = rows_of(out, "Training with faults", "network")
    change = row["with"]["faults"] - row["without"]["faults"]
    assert shown[-1][1] == f"{row['with']['faults']:.3f} ({change:+.3f})"


def test_unhardened_networks_must_be_others(data, runs, tmp_path, capsys):
    options = ["--out", str(tmp_path), "--runs", str(runs), "--unhardened", str(runs)]
    assert main(["evaluate", str(data), *options, "--parts", "realism-training"]) == 2
    assert "--unhardened holds no network" in capsys.readouterr().err


def test_the_networks_of_the_paper_stand_beside_lightnet_in_every_table(out):
    assert read(out, "table-3")["rows"][-1]["paper"] is None
    ours = [row for row in read(out, "table-2")["rows"] if row["variant"] == "lightnet"]
    assert [row["paper_rmse"] for row in ours] == [None, None]
    names = {row["name"] for row in read(out, "baselines")["rows"]}
    assert {"lightnet", "HemiCNN, RMSE_1"} < names


def test_calibration_and_failures_look_at_the_estimates_of_table_2(out):
    made = read(out, "estimates")["unseen"]
    (failure, *_) = read(out, "failures")["failures"]
    assert failure["estimate"] == made["networks"]["lightnet"]["ward"][failure["row"]]
    assert failure["truth"] == made["truths"][failure["row"]]
    assert made["networks"]["hemicnn-rmse1"]["stddev"] is None
    counted = read(out, "calibration")["splits"]["unseen"]["statuses"]
    statuses = made["networks"]["lightnet"]["statuses"]
    assert {row["status"]: row["scenes"] for row in counted if row["scenes"]}.items() >= {
        (name, statuses.count(name)) for name in set(statuses)
    }


def test_networks_that_are_untrained_are_left_out_and_others_measured(out):
    assert {row["variant"] for row in read(out, "perception")["rows"]} == set(MEASURED)
    names = {(curve["network"], curve["split"]) for curve in read(out, "views")["curves"]}
    assert names == {
        (name, split)
        for name in ("HemiCNN", "Grouplet-fast", "Grouplet-slow", "lightnet")
        for split in ("validation", "unseen")
    }
    assert {row["model"] for row in read(out, "latency")["rows"]} == {
        "hemicnn",
        "grouplet-fast",
        "grouplet-slow",
        "lightnet",
    }
    assert {row["variant"] for row in read(out, "eight-bit")["rows"]} == set(MEASURED)


def test_baselines_share_their_scenes(out):
    rows = read(out, "baselines")["rows"]
    small = [row for row in rows if row["accuracy"]["scenes"] == 2]
    assert {row["name"] for row in small if row["split"] == "unseen"} >= {
        "guessing the mean",
        "Lambertian from F and B",
        "one image, optimised",
    }
    assert all(row["median_seconds"] > 0 for row in rows)


def test_what_is_missing_is_said_in_one_sentence(data, tmp_path, capsys):
    assert main(["evaluate"]) == 2
    assert "needs DATA and --out, or --quick, or --compare" in capsys.readouterr().err
    out = ["--out", str(tmp_path)]
    assert main(["evaluate", str(data), *out, "--runs", str(tmp_path), "--parts", "views"]) == 2
    assert "holds no weights of a variant of Table 2" in capsys.readouterr().err
    assert main(["evaluate", str(data), *out, "--parts", "perception"]) == 2
    assert "run --parts table-2 first" in capsys.readouterr().err
    assert main(["evaluate", str(data), *out, "--parts"]) == 2
    assert "holds no records" in capsys.readouterr().err


def test_the_papers_rows_average_as_the_paper_says_where_they_can():
    assert len(TABLES_2_AND_3) == 7
    assert sorted(row.rank for row in TABLES_2_AND_3.values()) == [1, 2, 3, 4, 5, 6, 7]
    assert all(len(row.materials) == 10 for row in TABLES_2_AND_3.values())
