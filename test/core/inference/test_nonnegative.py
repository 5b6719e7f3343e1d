# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Non-negative least squares against SciPy's, and by the conditions of its optimum."""

import numpy as np
import pytest
from scipy.optimize import nnls

from reflest_core.inference.nonnegative import nonnegative_minimum


def problem(seed, rows=60, unknowns=20):
    rng = np.random.default_rng(seed)
    return rng.uniform(0, 1, (rows, unknowns)), rng.normal(size=rows)


def solved(columns, target, start=None):
    start = np.zeros(columns.shape[1]) if start is None else start
    return nonnegative_minimum(columns.T @ columns, columns.T @ target, start)


@pytest.mark.parametrize("seed", range(5))
def test_it_finds_what_scipy_finds(seed):
    columns, target = problem(seed)
    np.testing.assert_allclose(solved(columns, target), nnls(columns, target)[0], atol=2e-3)


@pytest.mark.parametrize("seed", range(5))
def test_nothing_can_be_gained_at_the_minimum(seed):
    """Karush-Kuhn-Tucker: no slope where an unknown is free, none downhill where it is 0."""
    columns, target = problem(seed)
    found = solved(columns, target)
    slope = columns.T @ (columns @ found - target)
    assert (found >= 0).all()
    assert (found == 0).any()
    np.testing.assert_allclose(slope[found > 0], 0, atol=5e-3)
    assert (slope[found == 0] > -5e-3).all()


def test_the_start_does_not_matter():
    columns, target = problem(7)
    far = np.full(columns.shape[1], 100.0)
    np.testing.assert_allclose(solved(columns, target, far), solved(columns, target), atol=2e-3)
