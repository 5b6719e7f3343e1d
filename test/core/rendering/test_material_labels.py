# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Labels are where their voxels are, nearer ones hide farther ones, ids keep their colours."""

from __future__ import annotations

import numpy as np

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.rendering.material_labels import (
    NOTHING,
    CameraView,
    labels_over,
    material_colours,
    voxel_near,
    voxels_in_image,
)

VIEW = CameraView(CameraIntrinsics(40, 30, 50.0, 50.0, 20.0, 15.0), np.eye(4))


def test_a_voxel_covers_the_pixels_around_its_projection():
    voxels = voxels_in_image(np.array([[0.1, -0.05, 1.0]]), VIEW, 0.05)
    rows, columns = np.nonzero(voxels == 0)
    assert (rows.mean(), columns.mean()) == (13.0, 25.0)
    assert len(rows) == 25
    assert (voxels[voxels != 0] == NOTHING).all()


def test_the_nearer_voxel_hides_the_farther_one_in_any_order():
    positions = np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 1.0], [0.0, 0.0, 3.0]])
    assert voxels_in_image(positions, VIEW, 0.05)[15, 20] == 1
    assert voxels_in_image(positions[::-1], VIEW, 0.05)[15, 20] == 1


def test_the_pose_moves_the_camera():
    moved = np.eye(4)
    moved[:3, 3] = [0.2, 0.0, -1.0]
    voxels = voxels_in_image(np.array([[0.2, 0.0, 0.0]]), CameraView(VIEW.intrinsics, moved), 0.05)
    assert voxels[15, 20] == 0


def test_what_is_behind_the_camera_or_far_beside_it_is_not_seen():
    positions = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 0.0], [1e9, 0.0, 0.1], [1e30, 0.0, 1.0]])
    assert (voxels_in_image(positions, VIEW, 0.05) == NOTHING).all()
    assert (voxels_in_image(np.zeros((0, 3)), VIEW, 0.05) == NOTHING).all()


def test_an_id_has_one_colour_and_its_neighbours_others():
    colours = material_colours(np.arange(60))
    assert (material_colours(np.array([7, 50])) == colours[[7, 50]]).all()
    distances = np.abs(colours[:, None].astype(int) - colours[None]).sum(axis=-1)
    assert distances[~np.eye(60, dtype=bool)].min() > 0


def test_labels_are_drawn_where_voxels_are_and_nowhere_else():
    rgb = np.full((30, 40, 3), 200, np.uint8)
    voxels = np.full((30, 40), NOTHING)
    voxels[10:20, 10:20], voxels[10:20, 20:30] = 0, 1
    drawn = labels_over(rgb, voxels, np.array([1, 2], np.uint32))
    assert (drawn[:8] == 200).all()
    assert (drawn[15, 15] != drawn[15, 25]).any()
    assert (drawn[15, 19] == 20).all()


def test_what_is_outside_of_the_bounds_is_dark_unless_it_is_a_material():
    rgb = np.full((30, 40, 3), 200, np.uint8)
    voxels = np.full((30, 40), NOTHING)
    voxels[10:20, 10:20] = 0
    is_scanned = np.zeros((30, 40), np.bool_)
    is_scanned[:5] = True
    drawn = labels_over(rgb, voxels, np.array([1], np.uint32), is_scanned)
    assert (drawn[:4] == 200).all()
    assert (drawn[25:] == 80).all()
    assert drawn[15, 15].max() > 100


def test_the_nearest_voxel_within_reach_is_found():
    positions = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]])
    assert voxel_near(positions, np.array([0.09, 0.0, 0.0]), 0.02) == 1
    assert voxel_near(positions, np.array([0.05, 0.3, 0.0]), 0.02) is None
    assert voxel_near(np.zeros((0, 3)), np.zeros(3), 1.0) is None
