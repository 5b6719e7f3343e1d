# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest evaluate`` measures every part and writes a page that holds the records' figures."""

import json

import cv2
import numpy as np
import pytest
from matplotlib.figure import Figure

from reflest_core.brdf import srgb
from reflest_core.cli import evaluate
from reflest_core.cli.main import main
from reflest_core.evaluation import parts, quick_check
from reflest_core.evaluation.networks import EvaluationError, network_named
from reflest_core.evaluation.paper_figures import MATERIALS, TABLES_2_AND_3
from reflest_core.evaluation.pictures import swatches
from reflest_core.evaluation.pictures.bumpy import SIZE
from reflest_core.evaluation.statistics.bootstrap import mean_of_roots_over_groups
from reflest_core.evaluation.studies import single_image, view_study
from reflest_core.models.card import LABCD_NAMES, WARD_NAMES
from reflest_core.models.predictor import Predictor
from reflest_core.training.data.sample import TrainingError, load_samples
from reflest_core.training.data.sample_file import read_samples
from test.core.evaluation.conftest import TRAINED

MEASURED = (*TRAINED, "lightnet")
FIGURES = {}
"""Every figure that the evaluation saved, by file name without suffix."""


@pytest.fixture(scope="module")
def out(data, runs, unhardened, tmp_path_factory):
    """The records and page of one evaluation of everything but the quick set."""
    folder = tmp_path_factory.mktemp("results")
    save = Figure.savefig

    def save_and_keep(figure, path, **options):
        FIGURES[str(path.relative_to(folder).with_suffix(""))] = figure
        save(figure, path, **options)

    effort = single_image.Effort(steps=3, starts=(0.1,))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(single_image, "Effort", lambda: effort)
        patch.setattr(Figure, "savefig", save_and_keep)
        patch.setattr(swatches, "ALPHAS", np.geomspace(0.001, 0.5, 3))
        patch.setattr(swatches, "STRATA", 2)
        patch.setattr(parts, "RENDERED", 3)
        patch.setattr(parts, "FEW_SCENES", 3)
        patch.setattr(view_study, "VIEW_COUNTS", (5, 20, 30))
        elsewhere = (
            "materials",
            "quick",
            "ablation",
            "look-around",
            "held-out-lights",
            "stability",
        )
        wanted = [part for part in parts.PARTS if part not in elsewhere]
        options = ["--out", str(folder), "--runs", str(runs), "--unhardened", str(unhardened)]
        options += ["--optimised", "2"]
        assert main(["evaluate", str(data), *options, "--parts", *wanted]) == 0
    return folder


def read(out, name):
    return json.loads((out / f"{name}.json").read_text())


def rows_of(out, heading, first_column):
    """Rows of the tables in the page's section ``heading``, each a list of (column, cell).

    Only tables whose first column has that name; cells are text, as they stand on the page.
    """
    page = (out / "index.md").read_text()
    section = page.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows, header = [], None
    for line in section.splitlines():
        if not line.startswith("|"):
            header = None
            continue
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if header is None:
            header = cells
        elif header[0] == first_column and not line.startswith("|---"):
            rows.append(list(zip(header, cells, strict=True)))
    return rows


def three(values):
    return [f"{value:.3f}" for value in values]


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


def test_table_2_on_the_page_has_the_records_figures_in_their_columns(out):
    rows = rows_of(out, "Table 2: the paper's variants and lightnet", "network")
    records = read(out, "table-2")["rows"]
    records = [r for split in ("validation", "unseen") for r in records if r["split"] == split]
    with_all = [dict(row) for row in rows if "95 %, scenes" in dict(row)]
    assert [row["network"] for row in with_all] == [record["title"] for record in records]
    for row, record in zip(with_all, records, strict=True):
        ward, around = record["accuracy"]["ward"], record["accuracy"]["over_scenes"]
        assert row["RMSE"] == f"{ward['overall']:.3f}"
        assert row["95 %, scenes"] == f"{around['low']:.3f} to {around['high']:.3f}"
        assert [row[name] for name in WARD_NAMES] == three(ward["per_parameter"])
        if record["split"] == "validation" and record["paper_rmse"] is not None:
            assert row["paper"] == f"{record['paper_rmse']:.3f}"
    of_labcd = [dict(row) for row in rows if "L" in dict(row)]
    for row, record in zip(of_labcd, records, strict=True):
        assert [row[name] for name in LABCD_NAMES] == three(
            record["accuracy"]["labcd"]["per_parameter"]
        )


def test_further_tables_have_the_records_figures_in_their_rows(out):
    ten, paper = read(out, "table-3"), len(MATERIALS)
    rows = rows_of(out, "Table 3: ten materials", "variant")
    for row, record in zip(rows, ten["rows"], strict=False):
        assert [cell for _, cell in row] == [
            record["title"],
            *three([record["average"], *record["errors"]]),
        ]
    assert len(rows[-1]) == 2 + paper

    curves = read(out, "views")["curves"]
    rows = rows_of(out, "Figure 6: error against the number of views", "network")
    assert [[cell for _, cell in row] for row in rows] == [
        [curve["network"], *three(curve["rmse"])]
        for split in ("validation", "unseen")
        for curve in curves
        if curve["split"] == split
    ]

    shown = {
        (row["method"], row["split"], row["scenes"]): row["RMSE"]
        for row in map(dict, rows_of(out, "Baselines", "method"))
    }
    assert shown == {
        (row["name"], row["split"], str(row["accuracy"]["scenes"])): (
            f"{row['accuracy']['ward']['overall']:.3f}"
        )
        for row in read(out, "baselines")["rows"]
    }

    shown = {row["variant"]: row for row in map(dict, rows_of(out, "Appearance", "rank"))}
    for row in read(out, "perception")["rows"]:
        assert shown[row["variant"]]["FLIP"] == f"{row['flip']:.3f}"
        assert shown[row["variant"]]["SSIM"] == f"{row['ssim']:.3f}"

    shown = {row["variant"]: row for row in map(dict, rows_of(out, "8-bit weights", "variant"))}
    for row in read(out, "eight-bit")["rows"]:
        assert shown[row["title"]]["8-bit"] == f"{row['eight_bit']:.4f}"
        assert shown[row["title"]]["float32"] == f"{row['float32']:.4f}"


def test_the_page_says_how_its_figures_were_made(out):
    assert (
        "- table-2: `reflest evaluate DATA --out docs/results --runs RUNS --unhardened UNHARDENED "
        "--optimised 2 --parts table-2`" in (out / "index.md").read_text()
    )


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


def test_calibration_on_the_page_has_the_records_figures_in_their_rows(out):
    splits = read(out, "calibration")["splits"]
    rows = [dict(row) for row in rows_of(out, "Calibration of the stated uncertainty", "split")]
    ratios = [r for r in rows if "quarter" not in r and "status" not in r and "%" not in r["alpha"]]
    assert [[r["split"], *(r[name] for name in WARD_NAMES)] for r in ratios] == [
        [split, *three(of["z_stddev"])] for split, of in splits.items()
    ]
    assert [(r["split"], r["stated"], r["RMSE"]) for r in rows if "quarter" in r] == [
        (split, *three([group["expected"], group["rmse"]]))
        for split, of in splits.items()
        for group in of["quartiles"]
    ]


def test_failures_on_the_page_come_worst_first_with_truth_estimate_and_reasons(out):
    found = read(out, "failures")["failures"]
    errors = [failure["error"] for failure in found]
    assert errors == sorted(errors, reverse=True)
    shown = rows_of(out, "Largest errors", "")
    assert [[cell for _, cell in row] for row in shown] == [
        [name, *three(failure[key])]
        for failure in found
        for name, key in (
            ("truth", "truth"),
            ("estimate", "estimate"),
            ("stated deviation", "stddev"),
        )
    ]
    page = (out / "index.md").read_text()
    for number, failure in enumerate(found, start=1):
        section = page.split(f"### {number}. ")[1].split("\n#")[0]
        assert all(reason in section for reason in failure["reasons"])
        assert f"({failure['picture']})" in section


def test_faults_and_voxels_on_the_page_have_the_records_figures_in_their_rows(out):
    record = read(out, "realism")
    rows = {row["effect"]: row["rmse"] for row in record["rows"]}
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
    assert rows["white-balance"]["lightnet"] != rows["none"]["lightnet"]
    shown = {
        row["fault"]: row for row in map(dict, rows_of(out, "Faults of real cameras", "fault"))
    }
    for fault, errors in rows.items():
        for network, error in errors.items():
            change = error - rows["none"][network]
            assert shown[fault][record["networks"][network]] == f"{error:.3f} ({change:+.3f})"
    points = read(out, "time-accuracy")["points"]
    assert [point["voxels"] for point in points] == [8, 16, 24, 32, 48]
    shown = [dict(row) for row in rows_of(out, "Accuracy against time", "voxels")]
    assert [row["RMSE"] for row in shown] == three(point["rmse"] for point in points)
    few = read(out, "views")["few"]["accuracy"]["unseen"]
    assert few["scenes"] == 4
    rows = rows_of(out, "Figure 6: error against the number of views", "split")
    assert dict(rows[-1])["RMSE"] == f"{few['ward']['overall']:.3f}"


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


def test_plots_show_the_records_numbers(out):
    record = read(out, "views")
    for axes, split in zip(FIGURES["views"].axes, record["scenes"], strict=True):
        drawn = {line.get_label(): line.get_ydata() for line in axes.lines[:-1]}
        for curve in record["curves"]:
            if curve["split"] == split:
                assert list(drawn[curve["network"]]) == curve["rmse"]
    for axes, of in zip(
        FIGURES["calibration"].axes, read(out, "calibration")["splits"].values(), strict=True
    ):
        for column, line in enumerate(axes.lines[1:]):
            np.testing.assert_array_equal(line.get_ydata(), np.array(of["observed"])[:, column])
            np.testing.assert_array_equal(line.get_xdata(), of["levels"])
    rows = read(out, "table-2")["rows"]
    titles = list(dict.fromkeys(row["title"] for row in rows))
    (axes,) = FIGURES["variants"].axes
    assert [label.get_text() for label in axes.get_yticklabels()] == titles
    by_label = dict(zip(("validation", "unseen"), axes.containers, strict=True))
    for split, container in by_label.items():
        assert list(container.lines[0].get_xdata()) == [
            row["accuracy"]["ward"]["overall"] for row in rows if row["split"] == split
        ]


def test_the_scatter_plot_shows_the_best_networks_estimates(out):
    rows = [row for row in read(out, "table-2")["rows"] if row["split"] == "validation"]
    best = min(rows, key=lambda row: row["accuracy"]["ward"]["overall"])["variant"]
    figure = FIGURES["scatter"]
    assert figure.get_suptitle() == best
    made = read(out, "estimates")["unseen"]
    alpha = figure.axes[-1].collections[0].get_offsets()
    np.testing.assert_array_equal(alpha[:, 0], np.array(made["truths"])[:, 4])
    np.testing.assert_array_equal(alpha[:, 1], np.array(made["networks"][best]["ward"])[:, 4])


def test_the_contact_sheet_shows_truth_and_estimates_in_their_rows(out):
    (axes,) = FIGURES["contact-sheet"].axes
    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert labels == ["truth", *read(out, "estimates")["validation"]["networks"]]
    sheet = np.asarray(axes.images[0].get_array())
    made, validation = read(out, "perception"), read(out, "estimates")["validation"]
    assert sheet.shape == (SIZE * len(labels), 2 * SIZE * made["materials"], 3)
    # Diffuse spheres are nearly proportional to rho_d: rows follow their own material's colour.
    drawn = np.random.default_rng(parts.RENDERED_SEED).permutation(len(validation["truths"]))[:3]
    wards = [validation["truths"], *(of["ward"] for of in validation["networks"].values())]
    for row, ward in enumerate(wards):
        for column, index in enumerate(drawn):
            block = sheet[
                SIZE * row : SIZE * (row + 1), 2 * SIZE * column : 2 * SIZE * column + SIZE
            ]
            middle = srgb.decode(block[SIZE // 3 : -SIZE // 3, SIZE // 3 : -SIZE // 3])
            shown = middle.reshape(-1, 3)
            # Under one light pictures of two materials are equal only where the materials are.
            truth_block = sheet[:SIZE, 2 * SIZE * column : 2 * SIZE * column + SIZE]
            is_same = np.allclose(ward[index], validation["truths"][index], atol=1e-6)
            assert np.allclose(block, truth_block) == is_same
            assert shown.min() >= 0.0
            assert shown.max() > 0.0
    assert (
        cv2.imread(str(out / "contact-sheet.png")).shape[1]
        > cv2.imread(str(out / "contact-sheet.png")).shape[0] / 10
    )


def test_pictures_of_failures_show_view_light_truth_and_estimate(out):
    found = read(out, "failures")["failures"]
    for number, failure in enumerate(found, start=1):
        panels = FIGURES[f"failures/{number:02d}"].axes
        titles = ["a view", "light (dim: not seen)", "truth", "estimate"]
        assert [panel.get_title() for panel in panels] == titles
        view, light, truth, estimate = (np.asarray(panel.images[0].get_array()) for panel in panels)
        assert view.shape == (36, 48, 3)
        assert light.shape == (96, 192, 3)
        brighter = np.array(failure["truth"][:3]).mean() > np.array(failure["estimate"][:3]).mean()
        if abs(np.mean(failure["truth"][:3]) - np.mean(failure["estimate"][:3])) > 0.1:
            assert (truth.mean() > estimate.mean()) == brighter


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
    quick_check.save_quick_set(path, samples)
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
    quick_check.save_quick_set(path, load_samples(data, "validation"))
    shipped = network_named(quick_check.find_networks(None), quick_check.VARIANT)
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
