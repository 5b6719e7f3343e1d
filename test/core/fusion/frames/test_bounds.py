# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What bounds a scan, in the world frame: the region of interest, else the work sphere."""

import numpy as np

from reflest_core.fusion.frames.region import RegionShape
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import orbit_frames

FUSION = FusionSettings(voxel_size=0.01, max_depth=1.0, memory_budget_mb=16.0)
FAR = np.array([5000.0, 0.0, 100.0])


def test_a_region_bounds_the_scan():
    region = RegionSettings("box", (0.0, 0.1, 0.0), (0.3, 0.2, 0.1))
    bounds = Scan(FUSION, region).bounds
    assert bounds.shape is RegionShape.BOX
    np.testing.assert_array_equal(bounds.half_size, [0.15, 0.1, 0.05])


def test_the_work_sphere_bounds_a_scan_without_a_region_from_its_first_frame_on():
    scan = Scan(FUSION, RegionSettings())
    assert scan.bounds.shape is RegionShape.NONE
    frame = orbit_frames(1)[0].relative_to(-FAR)
    scan.fuse(frame)
    bounds = scan.bounds
    assert bounds.shape is RegionShape.SPHERE
    assert np.linalg.norm(bounds.centre - FAR) < 0.2
    assert bounds.half_size[0] == scan.work_sphere.radius(FUSION) > 0.3


def test_pixels_within_the_bounds_are_those_whose_depth_lies_there():
    frame = orbit_frames(1)[0]
    scan = Scan(FUSION, RegionSettings("sphere", (0.0, 0.0, 0.0), (0.3,) * 3))
    np.testing.assert_array_equal(scan.bounds.shows(frame), frame.depth > 0.0)
    elsewhere = Scan(FUSION, RegionSettings("sphere", (9.0, 0.0, 0.0), (0.3,) * 3))
    assert not elsewhere.bounds.shows(frame).any()
    assert scan.bounds.shape is not RegionShape.NONE
