# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An estimate to export."""

from dataclasses import replace

from reflest_core.estimation.estimate import SCHEMA_VERSION, BrdfEstimate, EstimateStatus

GLOSSY_RED = BrdfEstimate(
    stamp_ns=1_750_000_000_123_456_789,
    frame_id="camera",
    schema_version=SCHEMA_VERSION,
    model_id="grouplet-slow/0123abcd",
    ward_variant="ward-1992",
    rho_d=(0.4, 0.08, 0.04),
    rho_s=0.2,
    alpha=0.1,
    lab=(46.0, 50.0, 35.0),
    c=0.2,
    d=0.9,
    voxel_count=5000,
    observation_count=80_000,
    view_count=90,
    coverage=0.4,
    status=EstimateStatus.OK,
    status_text="",
)


def glossy_red(**changes):
    return replace(GLOSSY_RED, **changes)
