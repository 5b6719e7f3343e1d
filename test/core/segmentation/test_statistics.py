# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Quantiles of colour over the views of a voxel."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.brdf import srgb
from reflest_core.segmentation.statistics import QUANTILES, voxel_colours


@given(st.lists(st.integers(0, 64), min_size=1, max_size=6), st.integers(0, 99))
def test_quantiles_are_those_of_sorted_channels(counts, seed):
    offsets = np.concatenate([[0], np.cumsum(counts)])
    colours = np.random.default_rng(seed).integers(0, 256, (offsets[-1], 3)).astype(np.uint8)
    found = voxel_colours(colours, offsets)
    for voxel, count in enumerate(counts):
        ranked = np.sort(colours[offsets[voxel] : offsets[voxel + 1]], axis=0)
        for quantile, values in zip(QUANTILES, (found.low, found.median, found.high), strict=True):
            eight_bit = ranked[int(quantile * (count - 1))] if count else np.zeros(3, int)
            np.testing.assert_array_equal(values[voxel], srgb.LINEAR[eight_bit])


def test_a_highlight_in_one_view_of_ten_raises_no_low_quantile():
    colours = np.full((10, 3), 40, np.uint8)
    colours[3] = 255
    found = voxel_colours(colours, np.array([0, 10]))
    np.testing.assert_array_equal(found.low[0], srgb.LINEAR[[40, 40, 40]])
    assert found.contrast[0] == 0.0


def test_contrast_is_larger_where_views_differ():
    matt, glossy = np.full((8, 3), 60), np.repeat([[60], [160]], 4, axis=0) * np.ones(3)
    found = voxel_colours(np.concatenate([matt, glossy]).astype(np.uint8), np.array([0, 8, 16]))
    assert found.contrast[0] == 0.0
    assert found.contrast[1] > 1.0


def test_no_voxels_have_no_quantiles():
    assert voxel_colours(np.zeros((0, 3), np.uint8), np.array([0])).low.shape == (0, 3)
