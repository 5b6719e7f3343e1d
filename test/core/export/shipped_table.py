# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The shipped table: its frames, its scan, its true surface, and a map of its true materials."""

from functools import cache
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.material_map import MaterialEstimate, MaterialMap
from reflest_core.evaluation.statistics.material_clouds import read_cloud
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.surface.partition import Partition
from test.core.export.estimates import glossy_red

CAPTURE = Path(__file__).parents[3] / "captures" / "table"


@cache
def frames():
    return list(open_capture(str(CAPTURE)))


@cache
def scan():
    found = Scan(FusionSettings(), RegionSettings())
    for frame in frames():
        found.fuse(frame)
    return found


def true_surface():
    """(N, 3) points and (N,) material ids, 0 for the table."""
    cloud = read_cloud(CAPTURE / "truth.ply")
    return np.stack([cloud[axis] for axis in "xyz"], axis=1), cloud["material_id"]


@cache
def true_materials():
    """A map of the scan with its true partition; ids are one more than the truth's."""
    surface = scan().snapshot()
    places, materials = true_surface()
    ids = materials[cKDTree(places).query(surface.positions)[1]].astype(np.int64) + 1
    estimates = tuple(
        MaterialEstimate(number, glossy_red(), (0.0,) * 3, (0.2, 0.2, 0.1), 0.06, int(count))
        for number, count in zip(*np.unique(ids, return_counts=True), strict=True)
    )
    unknown = np.full((len(ids), 3), np.nan, np.float32)
    return MaterialMap(
        1, "camera", surface, Partition.of(surface, ids), estimates, unknown, unknown
    )
