# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The demo as a process, on a small capture."""

from __future__ import annotations

import json
import subprocess
import sys

import cv2
import pytest
import trimesh
from own_process import ROOT
from sphere_messages import write_sphere_bag
from view_input import estimate as made_estimate

from reflest_ros.demo.comparison import compare, table

TRUTH = {
    "ward_variant": "ward-1992",
    "rho_d": [0.6, 0.2, 0.15],
    "rho_s": 0.1,
    "alpha": 0.12,
    "lab": [58.0, 35.0, 30.0],
    "c": 0.3,
    "d": 0.88,
}


FOR_TESTS = ("mitsuba", "skimage", "torch", "dask")
"""Modules that ``make demo`` does not install."""
RUN = f"""
import sys
sys.modules.update(dict.fromkeys({FOR_TESTS}))
from reflest_ros.demo.__main__ import main
sys.exit(main(sys.argv[1:]))
"""


def run_demo(*arguments):
    return subprocess.run(
        [sys.executable, "-c", RUN, *map(str, arguments)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=1100,
    )


def test_the_demo_shows_every_material_of_the_shipped_table(tmp_path):
    result = run_demo("--output", tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr
    truth = json.loads((ROOT / "captures" / "table" / "truth.json").read_text())
    rows = [words for words in map(str.split, result.stdout.splitlines()) if "truth" in words[1:2]]
    assert [words[0] for words in rows] == [one["part"] for one in truth["materials"]]
    assert result.stdout.count("  id ") >= len(rows)
    assert cv2.imread(str(tmp_path / "reflest-demo.png")).shape == (850, 1600, 3)
    asset = trimesh.load(tmp_path / "table.glb")
    # The table is 0.6 to 0.9 m wide, and the objects stand on it.
    assert 0.5 < max(asset.extents) < 1.2
    assert (tmp_path / "table.html").read_bytes().startswith(b"<!doctype html>")


@pytest.fixture
def capture(tmp_path):
    bag = write_sphere_bag(tmp_path / "red-sphere", count=6)
    (bag / "truth.json").write_text(json.dumps(TRUTH))
    return bag


def test_the_demo_compares_with_the_truth_and_draws(capture, tmp_path):
    result = run_demo("--capture", capture, "--output", tmp_path / "out")
    assert result.returncode == 0, result.stdout + result.stderr
    assert "/reflectance/brdf" in result.stdout
    rows = {words[0]: words[1:] for words in map(str.split, result.stdout.splitlines()) if words}
    numbers = [word for word in rows["alpha"] if not word.startswith("±")][:3]
    truth, estimate, error = map(float, numbers)
    assert truth == TRUTH["alpha"]
    assert error == pytest.approx(estimate - truth, abs=2e-3)
    picture = cv2.imread(str(tmp_path / "out" / "reflest-demo.png"))
    assert picture.shape == (750, 1600, 3)
    assert picture.std() > 20


def test_the_table_gives_deviations_where_they_are_known():
    lines = table(compare(made_estimate(alpha=0.1, alpha_stddev=0.03), TRUTH)).splitlines()
    (alpha,) = (line.split() for line in lines if line.split()[0] == "alpha")
    assert alpha[1:5] == ["0.120", "0.100", "±0.030", "-0.020"]
    (rho_s,) = (line for line in lines if line.split()[0] == "rho_s")
    assert "±" not in rho_s


def test_a_capture_without_truth_is_named_in_one_sentence(tmp_path):
    result = run_demo("--capture", tmp_path / "nothing", "--output", tmp_path / "out")
    assert result.returncode == 2
    assert "nothing/truth.json" in result.stderr
    assert "Traceback" not in result.stderr
