# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest evaluate`` measures every part and writes a page that holds the records' figures."""

import json

import cv2
import numpy as np
import pytest

from reflest_core.cli import evaluate
from reflest_core.cli.main import main
from reflest_core.evaluation import parts, quick_check, quick_set
from reflest_core.evaluation.contenders import EvaluationError
from reflest_core.evaluation.paper_figures import TABLES_2_AND_3
from reflest_core.evaluation.pictures import swatches
from reflest_core.evaluation.statistics.bootstrap import mean_of_roots_over_groups
from reflest_core.evaluation.studies import single_image, view_study
from reflest_core.models.predictor import Predictor
from reflest_core.training.data.sample import TrainingError, load_samples
from reflest_core.training.data.sample_file import read_samples
from test.core.evaluation.conftest import TRAINED

MEASURED = (*TRAINED, "lightnet")


@pytest.fixture(scope="module")
def out(data, runs, unhardened, tmp_path_factory):
    """The records and page of one evaluation of everything but the quick set."""
    folder = tmp_path_factory.mktemp("results")
    effort = single_image.Effort(steps=3, starts=(0.1,))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(single_image, "Effort", lambda: effort)
        patch.setattr(swatches, "ALPHAS", np.geomspace(0.001, 0.5, 3))
        patch.setattr(swatches, "STRATA", 2)
        patch.setattr(parts, "LOOKED_AT", 3)
        patch.setattr(parts, "FEW_SCENES", 3)
        patch.setattr(view_study, "VIEW_COUNTS", (5, 20, 30))
        elsewhere = ("quick", "ablation", "look-around", "held-out-lights")
        wanted = [part for part in parts.PARTS if part not in elsewhere]
        options = ["--out", str(folder), "--runs", str(runs), "--unhardened", str(unhardened)]
        options += ["--optimised", "2"]
        assert main(["evaluate", str(data), *options, "--parts", *wanted]) == 0
    return folder


def read(out, name):
    return json.loads((out / f"{name}.json").read_text())


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
    assert "## What holds them back" in (out / "index.md").read_text()


def test_every_figure_of_the_page_comes_from_a_record(out):
    page = (out / "index.md").read_text()
    for row in read(out, "table-2")["rows"]:
        assert f"{row['accuracy']['ward']['overall']:.3f}" in page
    for row in read(out, "table-3")["rows"]:
        assert all(f"{error:.3f}" in page for error in row["errors"])
    for curve in read(out, "views")["curves"]:
        assert all(f"{error:.3f}" in page for error in curve["rmse"])
    for row in read(out, "baselines")["rows"]:
        assert f"{row['accuracy']['ward']['overall']:.3f}" in page
    for row in read(out, "perception")["rows"]:
        assert f"{row['flip']:.3f}" in page
    for row in read(out, "eight-bit")["rows"]:
        assert f"{row['eight_bit']:.4f}" in page
    assert (
        "`reflest evaluate DATA --out docs/results --runs RUNS --unhardened UNHARDENED "
        "--optimised 2 --parts table-2`" in page
    )


def test_training_with_faults_is_compared_with_training_without(out):
    record = read(out, "realism-training")
    (row,) = record["rows"]
    assert row["network"] == "HemiCNN, RMSE_1"
    assert row["recipe"]["data"]["realism"] == "all"
    of_all = {one["effect"]: one["rmse"]["hemicnn-rmse1"] for one in read(out, "realism")["rows"]}
    assert row["with"] == {"clean": of_all["none"], "faults": of_all["all"]}
    assert row["with"]["clean"] != row["without"]["clean"]
    page = (out / "index.md").read_text()
    change = row["with"]["faults"] - row["without"]["faults"]
    assert f"{row['with']['faults']:.3f} ({change:+.3f})" in page


def test_unhardened_networks_must_be_others(data, runs, tmp_path, capsys):
    options = ["--out", str(tmp_path), "--runs", str(runs), "--unhardened", str(runs)]
    assert main(["evaluate", str(data), *options, "--parts", "realism-training"]) == 2
    assert "--unhardened holds no network" in capsys.readouterr().err


def test_every_part_of_lightnet_is_on_the_page(out):
    page = (out / "index.md").read_text()
    for split in read(out, "calibration")["splits"].values():
        assert all(f"{deviation:.3f}" in page for deviation in split["z_stddev"])
        assert all(f"{group['rmse']:.3f}" in page for group in split["quartiles"])
    found = read(out, "failures")["failures"]
    assert [failure["error"] for failure in found] == sorted(
        (failure["error"] for failure in found), reverse=True
    )
    for failure in found:
        assert all(reason in page for reason in failure["reasons"])
        assert all(f"{value:.3f}" in page for value in failure["estimate"])
        assert f"({failure['picture']})" in page
    rows = {row["effect"]: row["rmse"] for row in read(out, "realism")["rows"]}
    assert list(rows) == [
        "none",
        "exposure",
        "white-balance",
        "sensor",
        "jpeg",
        "depth",
        "pose",
        "normals",
        "all",
    ]
    assert all(f"{error:.3f} (" in page for row in rows.values() for error in row.values())
    assert rows["white-balance"]["lightnet"] != rows["none"]["lightnet"]
    points = read(out, "time-accuracy")["points"]
    assert [point["voxels"] for point in points] == [8, 16, 24, 32, 48]
    assert all(f"{point['rmse']:.3f}" in page for point in points)
    few = read(out, "views")["few"]["accuracy"]["unseen"]
    assert few["scenes"] == 4
    assert f"{few['ward']['overall']:.3f}" in page


def test_the_networks_of_the_paper_stand_beside_lightnet_in_every_table(out):
    assert read(out, "table-3")["rows"][-1]["paper"] is None
    ours = [row for row in read(out, "table-2")["rows"] if row["variant"] == "lightnet"]
    assert [row["paper_rmse"] for row in ours] == [None, None]
    names = {row["name"] for row in read(out, "baselines")["rows"]}
    assert {"lightnet (ours)", "HemiCNN, RMSE_1"} < names


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


def test_pictures_and_plots_are_drawn(out):
    plots = ("variants", "scatter", "views", "calibration", "time-accuracy")
    for name in (*plots, "contact-sheet", "failures/01", "failures/04"):
        assert cv2.imread(str(out / f"{name}.png")).std() > 5, name


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


def test_the_page_can_be_written_again_alone(out, data):
    before = (out / "index.md").read_text()
    assert main(["evaluate", str(data), "--out", str(out), "--parts"]) == 0
    assert (out / "index.md").read_text() == before


def test_the_quick_set_repeats_estimates_bit_for_bit(data, runs, tmp_path):
    samples = load_samples(data, "validation")
    path = tmp_path / "validation.safetensors"
    quick_set.save_quick_set(path, samples)
    small = read_samples(path)
    predictor = Predictor("hemicnn", runs / "hemicnn-rmse1" / "hemicnn-rmse1.safetensors")
    assert sum(s.surface.voxel_count for s in small) == 25 * len(samples)
    for kept, whole in zip(small, samples, strict=True):
        expected = predictor.predict(whole.surface).ward
        np.testing.assert_array_equal(predictor.predict(kept.surface).ward, expected)
        np.testing.assert_array_equal(kept.ward, whole.ward)
        assert kept.environment == whole.environment


def test_a_damaged_quick_set_is_named(tmp_path):
    path = tmp_path / "validation.safetensors"
    path.write_bytes(b"nothing")
    with pytest.raises(TrainingError, match=r"validation\.safetensors is damaged"):
        read_samples(path)


def test_a_row_that_is_not_reproduced_is_an_error(data, tmp_path):
    path, expected = tmp_path / "validation.safetensors", tmp_path / "expected.json"
    quick_set.save_quick_set(path, load_samples(data, "validation"))
    contender = quick_check.find_contenders(None)
    shipped = next(c for c in contender if c.name == quick_set.VARIANT)
    quick_check.write_expected(shipped, path)
    row = quick_check.reproduce_row(path, expected)
    assert row.accuracy.ward.overall == row.recorded
    record = json.loads(expected.read_text())
    expected.write_text(json.dumps({**record, "rmse": record["rmse"] + 0.01}))
    with pytest.raises(EvaluationError, match="does not estimate as it did"):
        quick_check.reproduce_row(path, expected)
    expected.write_text(json.dumps({**record, "model_id": "hemicnn/0"}))
    with pytest.raises(EvaluationError, match="Table 2 was measured with hemicnn/0"):
        quick_check.reproduce_row(path, expected)


def test_what_is_missing_is_said_in_one_sentence(data, tmp_path, capsys):
    assert main(["evaluate"]) == 2
    assert "needs DATA and --out, or --quick" in capsys.readouterr().err
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
