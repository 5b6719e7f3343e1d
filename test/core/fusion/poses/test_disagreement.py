# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A depth map contradicts surface that it sees through, and its own ghost behind it."""

import dataclasses

import numpy as np
import pytest

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.frame import Frame
from reflest_core.fusion.poses.disagreement import contradicted_blocks
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.surface.voxel_key import pack_key
from test.core.fusion.analytic_scene import Sphere, orbit_frames

CAMERA = CameraIntrinsics(width=80, height=60, fx=60.0, fy=60.0, cx=39.5, cy=29.5)
VOXEL = 0.01


def frame(depth):
    """A camera at the origin that looks along +z."""
    image = np.full((60, 80), depth, np.float32)
    return Frame(0, np.zeros((60, 80, 3), np.uint8), image, np.eye(4), CAMERA)


def plane(z, facing=True):
    """Keys, positions and normals of a plane at depth z, 16 x 16 voxels."""
    i, j = (index.ravel() for index in np.meshgrid(np.arange(-8, 8), np.arange(-8, 8)))
    k = round(z / VOXEL)
    keys = np.array([pack_key(a, b, k) for a, b in zip(i.tolist(), j.tolist(), strict=True)])
    positions = np.stack([i * VOXEL, j * VOXEL, np.full(len(i), z)], axis=1).astype(np.float32)
    normals = np.tile(np.float32([0, 0, -1 if facing else 1]), (len(i), 1))
    return keys, positions, normals


@pytest.mark.parametrize(
    ("surface", "seen", "is_contradicted"),
    [
        (plane(0.5), 0.5, False),
        (plane(0.5), 0.508, False),
        (plane(0.5), 0.6, True),
        (plane(0.5), 0.45, True),
        (plane(0.5), 0.3, False),
        (plane(0.5, facing=False), 0.45, False),
        (plane(0.5), 0.0, False),
    ],
    ids=["met", "noise", "seen through", "its ghost", "hidden", "its back", "no depth"],
)
def test_a_plane_is_contradicted(surface, seen, is_contradicted):
    found = contradicted_blocks(*surface, frame(seen))
    blocks = {pack_key(a, b, 6) for a in (-1, 0) for b in (-1, 0)}
    assert set(found.tolist()) == (blocks if is_contradicted else set())


def test_a_few_wrong_pixels_contradict_no_block():
    noisy = frame(0.5)
    noisy.depth[::4, ::4] = 0.9
    assert not len(contradicted_blocks(*plane(0.5), noisy))


def test_what_frames_after_a_jump_do_not_contradict_stays():
    """The sphere moves by 6 cm; a second one, which these frames do not show, keeps its voxels."""
    near, other = Sphere((0.0, 0.0, 0.0), 0.1), Sphere((0.0, 0.3, 0.0), 0.08)
    scan = Scan(FusionSettings(voxel_size=0.01, max_depth=1.0), RegionSettings())
    for one in orbit_frames(8, (near, other)):
        scan.fuse(one)
    before = scan.snapshot()
    scan.check_after_jump([])
    moved = Sphere((0.0, -0.06, 0.0), 0.1)
    for one in orbit_frames(8, (moved,)):
        scan.fuse(dataclasses.replace(one, stamp_ns=one.stamp_ns + 10**9))
    after = scan.snapshot()

    def count(surface, sphere):
        return (np.linalg.norm(surface.positions - sphere.centre, axis=1) < 0.11).sum()

    assert count(after, other) == count(before, other) > 100
    off = np.abs(np.linalg.norm(after.positions - moved.centre, axis=1) - moved.radius)
    is_near = np.linalg.norm(after.positions - other.centre, axis=1) > 0.11
    assert (off[is_near] < 0.02).mean() > 0.8
