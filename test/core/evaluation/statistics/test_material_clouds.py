# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of a cloud of materials whose errors are known."""

import math

import numpy as np
import pytest

from reflest_core.cli.main import main
from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.statistics.material_clouds import (
    SPREAD,
    compare_clouds,
    read_cloud,
    report,
)
from reflest_core.export.material_ply import VERTEX
from reflest_core.synbrdf.tabletop.truth import POINT, write_cloud

LARGE, SMALL = 900, 200
ALBEDO = {0: 0.2, 1: 0.05}


def true_cloud():
    """A square of two materials, the second on a small part of it."""
    points = np.zeros(LARGE + SMALL, POINT)
    points["x"] = np.arange(len(points)) % 40 * 0.01
    points["y"] = np.arange(len(points)) // 40 * 0.01
    points["nz"] = 1.0
    points["material_id"] = np.repeat([0, 1], [LARGE, SMALL])
    for channel in "rgb":
        points[f"rho_d_{channel}"] = np.where(points["material_id"] == 0, ALBEDO[0], ALBEDO[1])
    points["rho_s"], points["alpha"] = 0.05, 0.1
    return points


def found_cloud(truth):
    """The truth as it was found, with ids of another order and a deviation of each value."""
    found = np.zeros(len(truth), VERTEX)
    for name in truth.dtype.names:
        found[name] = truth[name]
    found["material_id"] = 9 - truth["material_id"]
    for name in VERTEX.names:
        if name.endswith("stddev"):
            found[name] = 0.01
    return found


def test_the_truth_has_no_errors():
    errors = compare_clouds(found_cloud(true_cloud()), true_cloud())
    assert (errors.z, errors.rmse, errors.log_rho_d) == (0.0, 0.0, 0.0)
    assert (errors.ari, errors.balanced_ari, errors.purity, errors.completeness) == (1, 1, 1, 1)
    assert (errors.matched, errors.materials, errors.found) == (1.0, 2, 2)
    assert errors.inside == [1.0] * 5


def test_z_is_the_mean_over_materials_of_rms_errors():
    truth = true_cloud()
    found = found_cloud(truth)
    is_small = truth["material_id"] == 1
    found["alpha"][is_small] += 0.12
    found["rho_s"][is_small] += 0.2
    errors = compare_clouds(found, truth)
    of_small = math.sqrt((2.0**2 + 1.0**2) / 5)
    assert errors.z_by_material == pytest.approx({0: 0.0, 1: of_small}, abs=1e-6)
    assert errors.z == pytest.approx(of_small / 2)
    assert errors.per_parameter == pytest.approx(
        [0, 0, 0, math.sqrt(0.5), math.sqrt(2.0)], abs=1e-5
    )
    assert errors.inside == pytest.approx([1, 1, 1, 0.5, 0.5])


def test_albedo_is_compared_by_ratio_materials_alike():
    truth = true_cloud()
    found = found_cloud(truth)
    for channel in "rgb":
        found[f"rho_d_{channel}"] *= np.where(truth["material_id"] == 0, 2.0, 1.0).astype("f4")
    # Half of the weight is off by a factor of two, half not at all.
    assert compare_clouds(found, truth).log_rho_d in (0.0, pytest.approx(math.log(2), abs=1e-5))
    for channel in "rgb":
        found[f"rho_d_{channel}"] *= np.where(truth["material_id"] == 1, 4.0, 1.0).astype("f4")
    assert math.log(2) - 1e-5 <= compare_clouds(found, truth).log_rho_d <= math.log(4) + 1e-5


def test_one_material_for_all_is_merged():
    truth = true_cloud()
    found = found_cloud(truth)
    found["material_id"] = 1
    errors = compare_clouds(found, truth)
    assert errors.balanced_ari == pytest.approx(0.0)
    assert (errors.purity, errors.completeness, errors.found) == (0.5, 1.0, 1)


def test_a_texture_is_judged_point_by_point():
    truth = true_cloud()
    truth["rho_d_g"][:LARGE:2] = 0.45
    flat = found_cloud(truth)
    flat["rho_d_g"][:LARGE] = 0.325
    errors = compare_clouds(flat, truth)
    # On half of the points the square's green is 0.125 too low, on half as much too high.
    assert errors.z_by_material[0] == pytest.approx(0.125 / SPREAD[1] / math.sqrt(5), rel=1e-4)
    assert compare_clouds(found_cloud(truth), truth).z == 0.0


def test_what_has_no_estimate_counts_as_wrong():
    truth = true_cloud()
    found = found_cloud(truth)
    for name in ("rho_d_r", "rho_d_g", "rho_d_b", "rho_s", "alpha"):
        found[name][truth["material_id"] == 1] = np.nan
    assert compare_clouds(found, truth).z_by_material[1] == pytest.approx(1.0)


def test_points_that_were_not_scanned_are_left_out():
    truth = true_cloud()
    errors = compare_clouds(found_cloud(truth)[:LARGE], truth)
    assert errors.materials == 1
    assert errors.matched == pytest.approx(LARGE / (LARGE + SMALL), abs=0.05)
    elsewhere = found_cloud(truth)
    elsewhere["z"] += 1.0
    with pytest.raises(EvaluationError, match="are both in the same world frame"):
        compare_clouds(elsewhere, truth)


def test_the_command_prints_the_errors_of_two_files(tmp_path, capsys):
    write_cloud(tmp_path / "truth.ply", true_cloud())
    assert np.array_equal(read_cloud(tmp_path / "truth.ply"), true_cloud())
    files = [str(tmp_path / "truth.ply")] * 2
    assert main(["evaluate", "--compare", *files]) == 0
    expected = compare_clouds(true_cloud(), true_cloud())
    assert capsys.readouterr().out.splitlines() == report(expected)
    (tmp_path / "none.ply").write_text("ply")
    assert main(["evaluate", "--compare", str(tmp_path / "none.ply"), files[0]]) == 2
    assert "is not a PLY file of materials" in capsys.readouterr().err
