# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Gaps in a grid are filled within surfaces and left open at edges; other depth stays as it is."""

import numpy as np
import pytest

from reflest_core.capture.images.depth_gaps import fill_gaps, has_gaps

ROWS, COLUMNS = np.mgrid[:60, :80].astype(np.float32)
PLANE = 0.5 + 0.0004 * COLUMNS + 0.0003 * ROWS


def registered(depth, every=4):
    """Depth without each so-manieth row and column, as projection into a larger image leaves it."""
    sparse = depth.astype(np.float32).copy()
    sparse[::every] = 0.0
    sparse[:, ::every] = 0.0
    return sparse


@pytest.mark.parametrize("every", [2, 3, 4])
def test_gaps_within_a_surface_are_filled_with_that_surface(every):
    sparse = registered(PLANE, every)
    filled = fill_gaps(sparse)
    inner = (slice(2, -2), slice(2, -2))
    assert (filled[inner] > 0.0).all()
    assert np.abs(filled - PLANE)[inner].max() < 1e-3
    assert np.array_equal(filled[sparse > 0.0], sparse[sparse > 0.0])


def test_a_gap_at_an_edge_stays_empty():
    step = np.where(COLUMNS < 40, 0.5, 0.8)  # column 40 is a gap
    filled = fill_gaps(registered(step))
    assert (filled[:, 40] == 0.0).all()
    values = filled[filled > 0.0]
    assert np.minimum(np.abs(values - 0.5), np.abs(values - 0.8)).max() < 1e-6


def test_dense_depth_with_holes_is_returned_untouched():
    depth = PLANE.copy()
    depth[20:30, 20:40] = 0.0
    depth[::9, ::9] = 0.0
    assert not has_gaps(depth)
    assert fill_gaps(depth) is depth


@pytest.mark.parametrize("shape", [(1, 1), (2, 3), (8, 2)])
def test_tiny_and_empty_depth_maps_are_no_trouble(shape):
    assert not has_gaps(np.zeros(shape, np.float32))
    fill_gaps(np.ones(shape, np.float32))
