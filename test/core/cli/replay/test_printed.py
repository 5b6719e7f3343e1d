# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a replay prints of many materials."""

import dataclasses

from reflest_core.cli.replay.printed import MOST_IDS, MOST_ROWS, material_lines
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.surface.partition import Partition
from test.core.lit_table import lit_table


def test_the_table_ends_with_what_it_leaves_out():
    surface = lit_table(voxel=0.01, table=0.14).surface
    settings = EstimationSettings(model="hemicnn", low_coverage=1.0)
    found = Estimator(settings).materials(surface, Partition.whole(surface), 5, "camera")
    (only,) = found.materials
    many = [dataclasses.replace(only, id=100 + index) for index in range(4 * MOST_ROWS)]
    lines = material_lines(dataclasses.replace(found, materials=tuple(many)))
    rows = [line for line in lines if line.lstrip().startswith("1")]
    assert len(rows) == MOST_ROWS
    assert lines[1 + MOST_ROWS].startswith(f"  and {3 * MOST_ROWS} smaller ones, 75% of the area")
    about_all = f" and {4 * MOST_ROWS - MOST_IDS} more: "
    assert sum(about_all in line for line in lines) == len(lines) - MOST_ROWS - 2 > 0
