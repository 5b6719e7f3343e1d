# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Thinning: a small surface whole, a large one evenly and well observed, with little looking."""

import numpy as np
import pytest

from reflest_core.surface.thinning import COMPARED, thinned


def test_a_small_surface_is_kept_but_for_voxels_without_observations():
    assert thinned(np.array([3, 0, 1, 0, 5], np.uint8), 5).tolist() == [0, 2, 4]
    assert thinned(np.zeros(0, np.uint8), 5).tolist() == []
    assert thinned(np.zeros(9, np.int64), 5).tolist() == []


@pytest.mark.parametrize("voxels", [1000, 1001, 123_457])
def test_a_large_one_is_thinned_evenly(voxels):
    kept = thinned(np.ones(voxels, np.uint8), 100)
    assert len(kept) == 100
    steps = np.diff(kept)
    assert steps.min() >= voxels // 100
    assert steps.max() <= voxels // 100 + 1


def test_the_best_observed_of_each_stretch_is_taken():
    counts = np.ones(1000, np.uint8)
    counts[7::10] = 9
    assert (counts[thinned(counts, 100)] == 9).all()


class CountingReads:
    """Stands for ``counts`` under the interpreted kernel and counts what is read of it."""

    def __init__(self, voxels):
        self.voxels, self.read = voxels, set()

    def __len__(self):
        return self.voxels

    def __getitem__(self, index):
        self.read.add(index)
        return 1


def test_a_tenfold_surface_costs_no_more_looking():
    looked_at = []
    for voxels in (100_000, 1_000_000):
        counts = CountingReads(voxels)
        thinned.py_func(counts, 500)
        looked_at.append(len(counts.read))
    assert looked_at == [500 * COMPARED] * 2
