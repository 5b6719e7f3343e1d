# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Felzenszwalb's graph segmentation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from reflest_core.segmentation.graph import graph_segments, renumbered, rising


def grid_graph(values):
    """Pairs and weights of a picture's 4-neighbourhood."""
    index = np.arange(values.size).reshape(values.shape)
    pairs = np.concatenate(
        [
            np.stack([index[:, :-1].ravel(), index[:, 1:].ravel()], axis=1),
            np.stack([index[:-1].ravel(), index[1:].ravel()], axis=1),
        ]
    ).astype(np.int32)
    flat = values.ravel()
    return pairs, np.abs(flat[pairs[:, 0]] - flat[pairs[:, 1]]).astype(np.float32)


def test_two_even_halves_are_two_segments():
    picture = np.zeros((20, 20))
    picture[:, 12:] = 10.0
    labels = graph_segments(*grid_graph(picture), picture.size, 50.0)
    np.testing.assert_array_equal(labels.reshape(20, 20), picture / 10.0)


def test_a_larger_scale_joins_more():
    picture = np.random.default_rng(0).normal(size=(30, 30))
    sizes = [graph_segments(*grid_graph(picture), 900, k).max() for k in (0.1, 1.0, 10.0, 1e6)]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-1] == 0


def test_vertices_without_edges_are_segments_of_their_own():
    labels = graph_segments(np.zeros((0, 2), np.int32), np.zeros(0, np.float32), 3, 1.0)
    np.testing.assert_array_equal(labels, [0, 1, 2])


def test_a_million_vertices_of_one_colour_are_one_segment():
    labels = graph_segments(*grid_graph(np.zeros((1000, 1000))), 1_000_000, 1.0)
    assert (labels == 0).all()


@given(npst.arrays(np.int64, st.integers(1, 40), elements=st.integers(0, 50)))
def test_renumbering_keeps_the_partition_and_has_no_gaps(labels):
    found = renumbered(labels)
    np.testing.assert_array_equal(found[:, None] == found, labels[:, None] == labels)
    firsts = np.unique(found, return_index=True)[1]
    assert (np.diff(firsts) > 0).all()
    assert found.max() + 1 == len(np.unique(labels))


@pytest.mark.parametrize("count", [0, 1, 5000])
def test_rising_is_a_stable_sort(count):
    rng = np.random.default_rng(count)
    weights = (rng.random(count) ** 8).astype(np.float32)
    weights[::3], weights[1::3] = 0.25, weights[1::3] * np.float32(1e-30)
    weights[::7], weights[5::7] = 0.0, -0.0
    np.testing.assert_array_equal(rising(weights), np.argsort(weights, kind="stable"))
