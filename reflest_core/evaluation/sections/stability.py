# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Section: how far estimates move when what should not matter changes."""

from __future__ import annotations

from reflest_core.evaluation.sections.markdown import Lines, Record, table
from reflest_core.models.card import WARD_NAMES


def stability(record: Record) -> Lines:
    """Section: movements of the estimate in units of its stated standard deviation.

    Args:
        record: Result of :func:`.measure_stability`.
    """
    subsets = f"{record['subsets']} subsets of {100 * record['kept']:.0f} %"
    return [
        "## Stability",
        "",
        f"Median over {len(record['captures'])} captures of how far estimates move, divided by",
        f"the standard deviation that they state: over {subsets} of the frames or of the voxels",
        "and over voxel sizes, their own standard deviation; with all colours one level brighter,",
        "a tenth of the frames left out, or poses wrong by 0.1 mm and 1e-4 rad, the distance from",
        "the unchanged estimate.",
        "",
        *table(["change", *WARD_NAMES], [[k, *of] for k, of in record["medians"].items()]),
        "",
    ]
