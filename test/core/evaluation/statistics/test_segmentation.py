# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Known values of the adjusted Rand index (those of scikit-learn), and what balance changes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.evaluation.statistics.segmentation import (
    adjusted_rand_index,
    balanced,
    completeness,
    contingency,
    purity,
)

labels = st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=2, max_size=60)


def index(truth, found):
    return adjusted_rand_index(contingency(np.array(truth), np.array(found)))


@pytest.mark.parametrize(
    ("truth", "found", "expected"),
    [
        # The examples in the documentation of sklearn.metrics.adjusted_rand_score.
        ([0, 0, 1, 1], [0, 0, 1, 1], 1.0),
        ([0, 0, 1, 1], [1, 1, 0, 0], 1.0),
        ([0, 0, 1, 2], [0, 0, 1, 1], 4 / 7),
        ([0, 0, 1, 1], [0, 0, 1, 2], 4 / 7),
        ([0, 0, 0, 0], [0, 1, 2, 3], 0.0),
        ([0, 0, 1, 1], [0, 1, 0, 1], -0.5),
    ],
)
def test_known_values(truth, found, expected):
    assert index(truth, found) == pytest.approx(expected)


def test_the_example_of_hubert_and_arabie():
    # Contingency table of Yeung and Ruzzo 2001, whose index is 0.313.
    table = np.array([[1, 1, 0], [1, 2, 1], [0, 0, 4]], float)
    assert adjusted_rand_index(table) == pytest.approx(0.313, abs=5e-4)


@given(labels)
def test_names_do_not_matter_and_the_index_is_symmetric(pairs):
    truth, found = np.array(pairs).T
    assert index(truth, found) == pytest.approx(index(found, truth))
    assert index(truth, 7 - found) == pytest.approx(index(truth, found))
    assert index(truth, truth) == pytest.approx(1.0)


@given(labels)
def test_pairs_are_counted_as_one_by_one(pairs):
    truth, found = np.array(pairs).T
    together = np.triu(np.equal.outer(truth, truth), 1), np.triu(np.equal.outer(found, found), 1)
    both, first, second = (together[0] & together[1]).sum(), together[0].sum(), together[1].sum()
    total = len(truth) * (len(truth) - 1) / 2
    expected, most = first * second / total, (first + second) / 2
    wanted = 1.0 if most == expected else (both - expected) / (most - expected)
    assert index(truth, found) == pytest.approx(wanted)


def test_labels_by_chance_have_an_index_near_zero():
    generator = np.random.default_rng(0)
    truth, found = generator.integers(0, 5, (2, 20_000))
    assert abs(index(truth, found)) < 0.01


def test_balance_weights_a_small_material_like_a_large_one():
    truth = np.repeat([0, 1, 2], [9000, 500, 500])
    merged = np.repeat([0, 1], [9000, 1000])
    table = contingency(truth, merged)
    assert adjusted_rand_index(table) > 0.95
    # Three equal materials of which two were merged: (1/3) / (... ) of the pairs agree.
    equal = adjusted_rand_index(contingency(np.repeat([0, 1, 2], 1000), np.repeat([0, 1, 1], 1000)))
    assert adjusted_rand_index(balanced(table)) == pytest.approx(equal, abs=1e-3)
    assert balanced(table).sum() == pytest.approx(table.sum())


def test_merging_shows_in_purity_and_dividing_in_completeness():
    truth = np.repeat([0, 1], 100)
    merged = contingency(truth, np.zeros(200, int))
    divided = contingency(truth, np.arange(200) // 50)
    assert (purity(merged), completeness(merged)) == (0.5, 1.0)
    assert (purity(divided), completeness(divided)) == (1.0, 0.5)
