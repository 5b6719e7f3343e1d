# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The part ``materials``: bags with truth are replayed, and the page has what was measured."""

import dataclasses
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from reflest_core.cli.main import main
from reflest_core.environment.environment_map import EnvironmentMap
from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.statistics.map_stability import change_between
from reflest_core.evaluation.studies.table_scenes import find_tables, irradiance_error, true_light
from reflest_core.export.environment_file import environment_bytes
from reflest_core.inference.light import SceneLight
from reflest_core.light.completion import LightPyramid
from reflest_core.rendering.environments import studio
from reflest_core.surface.partition import Partition
from reflest_core.synbrdf.tabletop.truth import POINT, write_cloud
from reflest_core.viewer.lights import octahedral_light
from test.core.export.scanned_ball import RED_ID, STRIPED_ID, scanned_ball

CAPTURE = Path(__file__).parents[4] / "captures" / "glossy-red"


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    """The shipped capture, said to be of one material wherever it is in a ball around it."""
    folder = tmp_path_factory.mktemp("tables")
    shutil.copytree(CAPTURE, folder / "01")
    truth = json.loads((CAPTURE / "truth.json").read_text())
    generator = np.random.default_rng(0)
    directions = generator.normal(size=(40_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = np.zeros(len(directions), POINT)
    places = directions * generator.uniform(0.05, 0.15, (len(directions), 1))
    points["x"], points["y"], points["z"] = places.T
    values = truth.get("estimate", truth)
    for k, channel in enumerate("rgb"):
        points[f"rho_d_{channel}"] = values["rho_d"][k]
    points["rho_s"], points["alpha"] = values["rho_s"], values["alpha"]
    write_cloud(folder / "01" / "truth.ply", points)
    return folder


def test_a_scene_is_measured_and_is_on_the_page(tables, tmp_path):
    out = ["--out", str(tmp_path), "--parts", "materials"]
    assert main(["evaluate", str(tables), *out]) == 0
    record = json.loads((tmp_path / "materials.json").read_text())
    (row,) = record["rows"]
    assert row["whole"]["z"] < 0.4
    assert row["materials"]["materials"] == 1
    (split,) = record["splits"].values()
    assert split["scenes"] == split["lights"] == 1
    assert split["means"]["materials"]["z"] == row["materials"]["z"]
    assert 0.0 <= row["kept"] <= 1.0
    assert "true_light" not in row
    assert split["means"]["seen_light"]["z"] == row["seen_light"]["z"]
    page = (tmp_path / "index.md").read_text()
    line = next(
        line for line in page.splitlines() if line.startswith("| many materials in one light |")
    )
    cells = [cell.strip() for cell in line.strip("|").split("|")]
    assert cells[1] == f"{split['means']['materials']['z']:.3f}"
    assert cells[5] == f"{split['means']['materials']['purity']:.3f}"


def test_a_folder_without_truth_is_named(tmp_path):
    with pytest.raises(EvaluationError, match=r"holds no scene with a truth\.ply"):
        find_tables(tmp_path)


def test_a_map_that_stays_keeps_its_ids_and_its_values():
    _, found = scanned_ball()
    change = change_between(found, found)
    assert change.kept == 1.0
    # The striped material states no deviation.
    assert change.steps == [0.0]


def test_swapped_ids_and_moved_values_are_seen():
    _, before = scanned_ball()
    red, striped = before.materials
    swapped = np.where(before.material_ids == RED_ID, STRIPED_ID, RED_ID)
    moved = dataclasses.replace(
        red, estimate=dataclasses.replace(red.estimate, alpha=red.estimate.alpha + 0.03)
    )
    after = dataclasses.replace(
        before, partition=Partition.of(before.surface, swapped), materials=(moved, striped)
    )
    change = change_between(before, after)
    assert change.kept == 0.0
    # A stated deviation of 0.01, a step of 0.03.
    assert change.steps == pytest.approx([3.0])


def test_the_error_of_the_light_is_that_of_its_irradiance(tmp_path):
    radiance = studio(64)
    nothing_unseen = np.ones(radiance.shape[:2], np.float32)
    light = EnvironmentMap(radiance, nothing_unseen, 0 * nothing_unseen)
    (tmp_path / "studio.hdr").write_bytes(environment_bytes(light, "hdr"))
    card = {
        "light": "distant",
        "environment": "studio",
        "environment_rotation": 1.0,
        "exposure": 2.0,
    }
    turned = true_light(card, tmp_path)
    known = octahedral_light(turned)
    _, found = scanned_ball()

    def error(factor):
        pyramid = LightPyramid([factor * known], np.zeros((96, 96, 3), np.float32))
        scene = SceneLight(found.surface.light, pyramid, pyramid, None, {}, {})
        return irradiance_error(dataclasses.replace(found, light=scene), turned)

    assert error(np.float32(1.0)) < 0.03
    assert error(np.float32(2.0)) == pytest.approx(np.log(2), abs=0.03)
    assert true_light({**card, "light": "near"}, tmp_path) is None
    assert true_light(card, None) is None


def test_an_environment_that_is_not_there_is_named(tmp_path):
    radiance = studio(64)
    nothing_unseen = np.ones(radiance.shape[:2], np.float32)
    light = EnvironmentMap(radiance, nothing_unseen, 0 * nothing_unseen)
    (tmp_path / "studio.hdr").write_bytes(environment_bytes(light, "hdr"))
    with pytest.raises(EvaluationError, match="has no forest"):
        true_light({"light": "distant", "environment": "forest"}, tmp_path)
