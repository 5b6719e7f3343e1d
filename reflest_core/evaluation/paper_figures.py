# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of Kim et al. 2017 that the page shows beside the measured ones."""

from __future__ import annotations

from dataclasses import dataclass

MATERIALS = (
    "m3331",
    "m3905",
    "m1161",
    "m3522",
    "m3665",
    "m1891",
    "m586",
    "m2646",
    "m3601",
    "m947",
)
"""The ten of Table 3."""


@dataclass(frozen=True)
class PaperRow:
    """A row of Tables 2 and 3 of the paper.

    Attributes:
        rmse: Normalised RMSE on the paper's validation set.
        rank: The rank that the paper's users gave.
        materials: RMSE of the ten :data:`MATERIALS`.
    """

    rmse: float
    rank: int
    materials: tuple[float, ...]


TABLES_2_AND_3 = {
    "grouplet-rmse1-ec": PaperRow(
        0.455, 1, (0.389, 0.224, 0.388, 0.885, 0.658, 0.504, 0.427, 0.112, 0.135, 0.272)
    ),
    "grouplet-rmse1": PaperRow(
        0.432, 2, (0.493, 0.232, 0.235, 0.734, 0.729, 0.514, 0.452, 0.175, 0.119, 0.200)
    ),
    "hemicnn-rmse2": PaperRow(
        0.564, 3, (0.153, 0.130, 1.341, 1.012, 0.588, 0.480, 0.406, 0.026, 0.184, 0.370)
    ),
    "hemicnn-cuberoot": PaperRow(
        0.439, 4, (0.356, 0.095, 1.282, 0.841, 0.680, 0.197, 0.557, 0.233, 0.304, 0.536)
    ),
    "hemicnn-rmse1": PaperRow(
        0.419, 5, (0.102, 0.080, 1.082, 0.966, 0.630, 0.288, 0.507, 0.075, 0.207, 0.325)
    ),
    "hemicnn-cuberoot-ec": PaperRow(
        0.583, 6, (0.481, 0.161, 1.274, 0.878, 0.742, 0.269, 0.590, 0.283, 0.330, 0.454)
    ),
    "grouplet-rmse2": PaperRow(
        0.457, 7, (0.493, 0.232, 0.440, 0.707, 0.665, 0.514, 0.378, 0.058, 0.155, 0.386)
    ),
}

LATENCY_MS = {"hemicnn": 16.0, "grouplet-fast": 5.0, "grouplet-slow": 90.0}
"""Section 3.3: average inference time for each scene; their machine is not named."""

SIZE_BYTES = {"hemicnn": 56_000, "grouplet": 339_000}
"""Section 3.3: "56K bytes" and "339K bytes"."""

USEFUL_VIEWS = 30
"""Figure 6: the error falls little beyond "around 30" views; its curves carry no numbers."""

OPTIMISER_SECONDS = 180.0
"""Section 4.2: Lombardi and Nishino "takes about 3 minutes to run"."""
