# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a replay prints of many materials."""

import dataclasses

import pytest

from reflest_core.cli.replay.printed import MOST_IDS, MOST_ROWS, final_lines, material_lines
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.surface.partition import Partition
from test.core.lit_table import lit_table


@pytest.fixture(scope="module")
def found():
    """A map of one material."""
    surface = lit_table(voxel=0.01, table=0.14).surface
    settings = EstimationSettings(model="hemicnn", low_coverage=1.0)
    return Estimator(settings).materials(surface, Partition.whole(surface), 5, "camera")


def with_estimate(found, **values):
    (only,) = found.materials
    estimate = dataclasses.replace(only.estimate, **values)
    return dataclasses.replace(found, materials=(dataclasses.replace(only, estimate=estimate),))


def test_the_table_ends_with_what_it_leaves_out(found):
    (only,) = found.materials
    many = [dataclasses.replace(only, id=100 + index) for index in range(4 * MOST_ROWS)]
    lines = material_lines(dataclasses.replace(found, materials=tuple(many)))
    rows = [line for line in lines if line.lstrip().startswith("1")]
    assert len(rows) == MOST_ROWS
    assert lines[1 + MOST_ROWS].startswith(f"  and {3 * MOST_ROWS} smaller ones, 75% of the area")
    about_all = f" and {4 * MOST_ROWS - MOST_IDS} more: "
    assert sum(about_all in line for line in lines) == len(lines) - MOST_ROWS - 2 > 0


def test_dark_albedos_have_two_significant_digits(found):
    dark = with_estimate(
        found,
        rho_d=(0.31, 0.0034, 0.00001),
        rho_d_stddev=(0.12, 0.0125, 0.0),
        rho_s=0.025,
        rho_s_stddev=0.0071,
    )
    (row,) = [line for line in material_lines(dark) if "±" in line]
    assert "0.31 0.0034 0.0000 ± 0.12 0.013 0.00  " in row
    assert "0.025 ± 0.0071" in row


def test_a_roughness_of_the_prior_is_marked(found):
    known = with_estimate(found, alpha=0.1, alpha_stddev=0.05, status_text="")
    assert not any("*" in line for line in material_lines(known))
    sentence = "alpha cannot be determined: the surface is matte"
    unknown = with_estimate(found, alpha=0.1, alpha_stddev=0.05, status_text=sentence)
    lines = material_lines(unknown)
    assert "0.10 ± 0.050*" in lines[1]
    assert lines[2].startswith("  * alpha and its deviation are mostly the prior's")


def test_the_final_estimate_says_where_it_is_not_from_all_voxels(found):
    estimate = found.materials[0].estimate
    assert "10,000 voxels alone" in final_lines(estimate, thinned_to=10_000)[1]
    assert "  of  " not in "".join(final_lines(estimate))
