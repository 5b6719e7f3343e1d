# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""True materials are found among published ones by where they lie."""

import numpy as np
import pytest
from view_input import estimate as made_estimate

from reflest_ros.demo.matched_materials import match_materials, material_table
from reflest_ros.outputs.material_message import POINT


def card(number, part, red, seen=0.5):
    return {
        "id": number,
        "part": part,
        "rho_d_mean": [red, 0.2, 0.1],
        "rho_s": 0.05,
        "alpha": 0.1,
        "seen_share": seen,
    }


TRUTH = {"materials": [card(0, "table", 0.4), card(1, "object-1", 0.6), card(2, "x", 0.1, 0.001)]}


def records(dtype, places, ids):
    made = np.zeros(len(places), dtype)
    for k, axis in enumerate("xyz"):
        made[axis] = np.asarray(places)[:, k]
    made["material_id"] = ids
    return made


@pytest.fixture
def points():
    """A row of points 5 mm apart: material 0 left of x = 0.1, 1 to its right."""
    x = np.arange(0.0, 0.2, 0.005)
    kind = [("x", "f4"), ("y", "f4"), ("z", "f4"), ("material_id", "u4")]
    return records(np.dtype(kind), np.column_stack([x, 0 * x, 0 * x]), (x >= 0.0999).astype(int))


def test_a_material_is_the_one_that_covers_most_of_it(points):
    x = np.arange(0.0, 0.2, 0.005)
    places = np.column_stack([x, 0 * x, 0 * x + 0.002])
    # 7 spreads a quarter into what is 9's.
    ids = np.where(x < 0.1249, 7, 9)
    voxels = records(POINT, places, ids)
    matched = match_materials(TRUTH, points, voxels, {7: made_estimate(), 9: made_estimate()})
    assert [(one.part, one.id) for one in matched] == [("table", 7), ("object-1", 9)]
    assert matched[0].share == 1.0
    assert matched[1].share == pytest.approx(0.75)
    assert matched[1].truth.rho_d == (0.6, 0.2, 0.1)


def test_voxels_away_from_the_true_surface_and_ids_without_an_estimate_count_for_nothing(points):
    x = np.arange(0.0, 0.1, 0.005)
    near = np.column_stack([x, 0 * x, 0 * x])
    away = near + np.array([0.0, 0.0, 0.05])
    voxels = np.concatenate([records(POINT, near, 3), records(POINT, away, 4)])
    matched = match_materials(TRUTH, points, voxels, {3: made_estimate(), 4: made_estimate()})
    assert [(one.part, one.id, one.share) for one in matched] == [("table", 3, 1.0)]
    assert not match_materials(TRUTH, points, voxels, {5: made_estimate()})


def test_the_table_shows_truth_above_estimate(points):
    found = made_estimate()
    x = np.arange(0.0, 0.1, 0.005)
    voxels = records(POINT, np.column_stack([x, 0 * x, 0 * x]), 3)
    _, truth, estimate = material_table(match_materials(TRUTH, points, voxels, {3: found})).split(
        "\n"
    )
    assert truth.split()[:5] == ["table", "truth", "0.40", "0.20", "0.10"]
    assert estimate.split()[:3] == ["id", "3", f"{found.rho_d[0]:.2f}"]
    assert estimate.split()[-1] == found.status.name
