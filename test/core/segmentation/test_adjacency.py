# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which voxels are neighbours."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from reflest_core.segmentation.adjacency import neighbour_pairs


@pytest.mark.parametrize("seed", range(4))
def test_pairs_are_those_of_a_tree(seed):
    rng = np.random.default_rng(seed)
    positions = rng.uniform(-0.05, 0.05, (400, 3)).astype(np.float32)
    found = neighbour_pairs(positions, 0.012)
    expected = cKDTree(positions.astype(np.float64)).query_pairs(0.012)
    assert set(map(tuple, found.tolist())) == expected
    assert (found[:, 0] < found[:, 1]).all()
    assert (np.diff(found[:, 0]) >= 0).all()


def test_a_grid_of_5_mm_has_8_neighbours_in_its_plane():
    i, j = np.meshgrid(np.arange(10), np.arange(10))
    positions = np.stack([i.ravel(), j.ravel(), 0 * i.ravel()], axis=1) * np.float32(0.005)
    degrees = np.bincount(neighbour_pairs(positions).ravel(), minlength=100)
    assert degrees.reshape(10, 10)[1:-1, 1:-1].min() == 8
    assert degrees.max() == 8


@pytest.mark.parametrize("count", [0, 1])
def test_few_voxels_have_no_neighbours(count):
    assert neighbour_pairs(np.zeros((count, 3), np.float32)).shape == (0, 2)


def test_many_voxels_in_one_place_are_all_neighbours():
    assert len(neighbour_pairs(np.zeros((40, 3), np.float32))) == 40 * 39 // 2


def test_a_million_voxels():
    i, j = np.meshgrid(np.arange(1000), np.arange(1000), indexing="ij")
    positions = np.stack([i.ravel(), j.ravel(), 0 * i.ravel()], axis=1).astype(np.float32)
    assert len(neighbour_pairs(positions, 1.1)) == 2 * 1000 * 999
