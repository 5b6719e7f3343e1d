# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan of a ball of two materials: the upper half glossy red, the lower matt with stripes."""

import dataclasses
from functools import cache

import numpy as np

from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.material_map import MaterialEstimate, MaterialMap
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.surface.partition import Partition
from test.core.export.estimates import glossy_red
from test.core.fusion.analytic_scene import orbit_frames

RADIUS = 0.1
VOXEL = 0.008
RED_ID, STRIPED_ID = 7, 3
STRIPE = 0.04
DARK, BRIGHT = np.array([0.05, 0.1, 0.2]), np.array([0.5, 0.6, 0.7])


@cache
def scanned_ball():
    """The scan and the map of its materials."""
    scan = Scan(FusionSettings(voxel_size=VOXEL, max_depth=1.0), RegionSettings())
    for frame in orbit_frames(24):
        scan.fuse(frame)
    surface = scan.snapshot()
    is_red = surface.positions[:, 2] > 0
    estimates = {
        RED_ID: glossy_red(rho_d_stddev=(0.01, 0.02, 0.03), rho_s_stddev=0.02, alpha_stddev=0.01),
        STRIPED_ID: glossy_red(
            rho_d=(0.3, 0.35, 0.45),
            rho_s=0.02,
            alpha=0.2,
            status=EstimateStatus.UNCERTAIN_GLOSS,
            status_text="the roughness is hardly known",
        ),
    }
    rho_d = np.where(is_red[:, None], estimates[RED_ID].rho_d, striped(surface.positions))
    return scan, MaterialMap(
        1,
        "camera",
        surface,
        Partition.of(surface, np.where(is_red, RED_ID, STRIPED_ID)),
        tuple(
            MaterialEstimate(number, estimate, (0.0,) * 3, (0.2, 0.2, 0.1), 0.06, int(n))
            for (number, estimate), n in zip(
                estimates.items(), (is_red.sum(), (~is_red).sum()), strict=True
            )
        ),
        rho_d.astype(np.float32),
        np.full(rho_d.shape, 0.05, np.float32),
    )


def striped(positions):
    """(P, 3) rho_d of the lower half: stripes along x."""
    is_bright = np.floor(positions[:, 0] / STRIPE) % 2 == 0
    return np.where(is_bright[:, None], BRIGHT, DARK)


def without_albedo():
    """The same with unknown albedo of every voxel."""
    scan, found = scanned_ball()
    return scan, dataclasses.replace(found, rho_d=np.full_like(found.rho_d, np.nan))
