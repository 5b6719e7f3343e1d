# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The page of an evaluation holds its records' figures."""

from reflest_core.cli.main import main
from reflest_core.evaluation.paper_figures import MATERIALS
from reflest_core.models.card import LABCD_NAMES, WARD_NAMES
from test.core.evaluation.results import read, rows_of, three


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


def test_faults_and_few_views_on_the_page_have_the_records_figures_in_their_rows(out):
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
    few = read(out, "views")["few"]["accuracy"]["unseen"]
    assert few["scenes"] == 4
    rows = rows_of(out, "Figure 6: error against the number of views", "split")
    assert dict(rows[-1])["RMSE"] == f"{few['ward']['overall']:.3f}"


def test_the_page_can_be_written_again_alone(out, data):
    before = (out / "index.md").read_text()
    assert main(["evaluate", str(data), "--out", str(out), "--parts"]) == 0
    assert (out / "index.md").read_text() == before
