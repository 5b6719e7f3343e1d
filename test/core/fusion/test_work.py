# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How much work frames cost, counted rather than timed, and so steady on any machine."""

import dataclasses

import numpy as np

from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.tsdf import volume as tsdf
from test.core.fusion.analytic_scene import OBJECT, Sphere, look_at, orbit_frames, render

SETTINGS = FusionSettings(max_depth=1.0, work_radius=100.0)
COUNTS = (
    "blocks_projected",
    "blocks_changed",
    "surface_voxels",
    "voxels_seen",
    "observations_kept",
)


def work_of(fused):
    return tuple(getattr(fused, name) for name in COUNTS)


def test_an_orbit_of_the_sphere_costs_what_it_cost():
    scan = Scan(SETTINGS, RegionSettings())
    work = np.array([work_of(scan.fuse(frame)) for frame in orbit_frames(24)])
    # Measured when this was written; a little may change with the order of floating-point sums.
    np.testing.assert_allclose(work[0], [41, 37, 807, 807, 807], rtol=0.01)
    np.testing.assert_allclose(work.sum(axis=0), [2819, 1040, 32604, 22269, 22269], rtol=0.01)


def test_only_blocks_near_the_surface_are_looked_at_in_a_single_view():
    """The visible cap of the sphere, two voxels to either side, in blocks of 4 cm edge."""
    scan = Scan(SETTINGS, RegionSettings())
    fused = scan.fuse(orbit_frames(1)[0])
    cap_area = 2 * np.pi * OBJECT.radius**2
    block_edge = 8 * SETTINGS.voxel_size
    assert fused.blocks_projected < 6 * cap_area / block_edge**2
    assert fused.surface_voxels < 1.5 * cap_area / SETTINGS.voxel_size**2


def test_a_region_leaves_the_rest_out():
    spheres = [OBJECT, Sphere((0.0, 0.3, 0.0), 0.1), Sphere((0.0, -0.3, 0.0), 0.1)]
    region = RegionSettings("box", OBJECT.centre, (0.25, 0.25, 0.25))
    frame = render(spheres, look_at((0.6, 0.0, 0.1)), 0)
    everything = Scan(SETTINGS, RegionSettings()).fuse(frame)
    object_alone = Scan(SETTINGS, region).fuse(frame)
    assert object_alone.blocks_projected < 0.5 * everything.blocks_projected


def far_away(count):
    """Frames of spheres in a row, each out of the others' sight."""
    for n in range(1, count + 1):
        place = (3.0 * n, 0.0, 0.0)
        camera = look_at((place[0] + 0.5, 0.0, 0.0), place)
        yield render([dataclasses.replace(OBJECT, centre=place)], camera, 0, stamp_ns=n)


def test_a_frame_costs_the_same_whatever_was_scanned_before(monkeypatch):
    monkeypatch.setattr(tsdf, "MOST_BESIDE", 128)
    orbit = [render([OBJECT], f.T_world_camera, n) for n, f in enumerate(orbit_frames(6))]
    small, large = Scan(SETTINGS, RegionSettings()), Scan(SETTINGS, RegionSettings())
    for frame in far_away(30):
        large.fuse(frame)
    assert large.volume.count > 1000
    for frame in orbit:
        one, other = small.fuse(frame), large.fuse(frame)
        assert other.voxels_seen == one.voxels_seen
        assert other.observations_kept == one.observations_kept
        assert other.surface_voxels <= one.surface_voxels
        assert other.blocks_changed <= one.blocks_changed
        assert other.blocks_projected <= one.blocks_projected + 128
