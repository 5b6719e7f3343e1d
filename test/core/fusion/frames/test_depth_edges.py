# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np

from reflest_core.fusion.frames.depth_edges import clear_of_edges, depth_tolerance

VOXEL = 0.005


def test_step_is_an_edge_on_both_sides_as_far_as_the_margin():
    depth = np.full((9, 20), 1.0, np.float32)
    depth[:, 10:] = 1.0 + depth_tolerance(1.0, VOXEL) + 0.002
    clear = clear_of_edges(depth, VOXEL, margin=2)
    assert clear[4].tolist() == [True] * 8 + [False] * 4 + [True] * 8


def test_step_within_tolerance_is_no_edge():
    depth = np.full((9, 20), 1.0, np.float32)
    depth[:, 10:] = 1.0 + depth_tolerance(1.0, VOXEL) - 0.002
    assert clear_of_edges(depth, VOXEL, margin=2).all()


def test_border_to_unknown_depth_is_an_edge():
    depth = np.full((9, 20), 1.0, np.float32)
    depth[:, 15:] = 0.0
    clear = clear_of_edges(depth, VOXEL, margin=3)
    assert clear[4].tolist() == [True] * 12 + [False] * 8


def test_margin_is_a_square_around_a_hole():
    depth = np.full((11, 11), 1.0, np.float32)
    depth[5, 5] = 0.0
    clear = clear_of_edges(depth, VOXEL, margin=1)
    assert not clear[4:7, 4:7].any()
    assert clear.sum() == 121 - 9
