# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Stability: changes that do nothing move nothing, and ratios are in stated deviations."""

import dataclasses
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from reflest_core.cli.main import main
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.sections.uncertainty import stability
from reflest_core.evaluation.studies import stability as study

CAPTURE = Path(__file__).parents[4] / "captures" / "glossy-red"


@pytest.fixture(autouse=True)
def few(monkeypatch):
    monkeypatch.setattr(study, "SUBSETS", 2)
    monkeypatch.setattr(study, "VOXEL_SIZES", (0.005, 0.008))
    monkeypatch.setattr(study, "LEFT_OUT", 1)
    whole = study.open_capture
    monkeypatch.setattr(study, "open_capture", lambda path: list(whole(path))[::6])


def test_the_shipped_capture_is_stable_and_the_page_says_so(tmp_path):
    out = tmp_path / "out"
    assert main(["evaluate", str(CAPTURE), "--out", str(out), "--parts", "stability"]) == 0
    record = json.loads((out / "stability.json").read_text())
    assert record["captures"] == ["glossy-red"]
    assert record["provenance"]["data"] == "one capture"
    medians = {kind: np.array(of) for kind, of in record["medians"].items()}
    assert list(medians) == [
        "70 % of frames",
        "70 % of voxels",
        "voxels of 3, 5, 8 mm",
        "one grey level",
        "another tenth of frames left out",
        "poses by 1e-4",
    ]
    for kind, ratios in medians.items():
        assert (ratios > 0.0).all(), kind
    assert (medians["one grey level"] < 1.0).all()
    assert (medians["poses by 1e-4"] < 1.0).all()
    page = (out / "index.md").read_text()
    assert f"| 70 % of voxels | {medians['70 % of voxels'][0]:.3f} |" in page


def test_a_change_that_does_nothing_moves_nothing(monkeypatch):
    monkeypatch.setattr(study, "KEPT", 1.1)
    monkeypatch.setattr(study, "POSE_ERROR", 0.0)
    monkeypatch.setattr(study, "VOXEL_SIZES", (0.005, 0.005))
    monkeypatch.setattr(study, "_brighter", lambda frame: frame)
    record = study.measure_stability([CAPTURE])
    for kind, ratios in record["ratios"].items():
        if kind != "another tenth of frames left out":
            np.testing.assert_array_equal(ratios, 0.0)


def test_a_network_without_deviations_has_no_ratios():
    settings = ReflestSettings(estimation=EstimationSettings(model="hemicnn"))
    record = study.measure_stability([CAPTURE], settings)
    assert np.isnan(record["medians"]["70 % of voxels"]).all()


def test_captures_are_found_by_name_and_their_absence_is_said(tmp_path):
    with pytest.raises(EvaluationError, match="holds no captures"):
        study.find_captures(tmp_path)
    for name in ("b", "a"):
        (tmp_path / name).mkdir()
        shutil.copy(CAPTURE / "metadata.yaml", tmp_path / name)
    assert [path.name for path in study.find_captures(tmp_path)] == ["a", "b"]
    assert study.find_captures(CAPTURE) == [CAPTURE]


def test_only_black_to_light_grey_grow_brighter():
    frame = next(iter(study.open_capture(CAPTURE)))
    white = dataclasses.replace(frame, rgb=np.full((2, 2, 3), 255, np.uint8))
    assert (study._brighter(white).rgb == 255).all()
    assert (study._brighter(frame).rgb.astype(int) - frame.rgb).max() == 1


def test_the_section_names_how_it_was_measured():
    record = {"captures": ["a"], "kept": 0.7, "subsets": 4, "medians": {"x": [0.1] * 5}}
    assert "over 4 subsets of 70 %" in "\n".join(stability(record))
