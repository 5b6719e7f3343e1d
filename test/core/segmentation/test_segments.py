# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Segments of a scanned table, and of made-up surfaces."""

import numpy as np
import pytest

from reflest_core.segmentation.adjacency import neighbour_pairs
from reflest_core.segmentation.scraps import attach_scraps
from reflest_core.segmentation.segments import COARSE, FINE, MOST_SEGMENTS, segment
from reflest_core.segmentation.statistics import VoxelColours


def board(edge=60, step=0.005):
    """A flat grid of voxels: positions and normals."""
    i, j = np.meshgrid(np.arange(edge), np.arange(edge), indexing="ij")
    positions = np.stack([i.ravel(), j.ravel(), 0 * i.ravel()], axis=1) * np.float32(step)
    return positions, np.tile(np.float32([0.0, 0.0, 1.0]), (edge * edge, 1))


def painted(positions, colour_of, seed=0):
    """Quantiles of colours (V, 3) with a little noise."""
    noise = 1.0 + 0.03 * np.random.default_rng(seed).normal(size=(len(positions), 1))
    colours = np.asarray(colour_of * noise, np.float32)
    return VoxelColours(colours, colours * 1.05, colours * 1.1)


RED, GREEN = np.array([0.4, 0.05, 0.05]), np.array([0.05, 0.3, 0.05])


def segmented(positions, normals, colours, irradiance=None, size=COARSE):
    white = np.ones_like(colours.low) if irradiance is None else irradiance
    return segment(positions, normals, neighbour_pairs(positions), colours, white, size)


@pytest.mark.parametrize("size", [FINE, COARSE])
def test_two_colours_are_two_segments(size):
    positions, normals = board()
    truth = (positions[:, 0] > 0.1).astype(int)
    colours = painted(positions, np.where(truth[:, None] == 1, RED, GREEN))
    np.testing.assert_array_equal(segmented(positions, normals, colours, size=size), truth)


def test_light_is_divided_out():
    positions, normals = board()
    light = np.repeat(0.2 + 3.0 * positions[:, :1], 3, axis=1).astype(np.float32)
    colours = painted(positions, RED * light)
    assert segmented(positions, normals, colours, light).max() == 0


def test_a_crease_divides_one_colour():
    positions, normals = board(60)
    wall = positions[:, [2, 1, 0]] + np.float32([0.0, 0.0, 0.005])
    places = np.concatenate([positions, wall])
    facing = np.concatenate([normals, normals[:, [2, 1, 0]]])
    labels = segmented(places, facing, painted(places, RED + 0 * places), size=FINE)
    assert set(labels[:3600]).isdisjoint(labels[3600:])


def test_permuted_voxels_have_the_same_partition():
    positions, normals = board()
    truth = (positions[:, 0] > 0.1).astype(int) + 2 * (positions[:, 1] > 0.2)
    paint = np.stack([RED, GREEN, RED + GREEN, 0.5 * GREEN + 0.3])[truth]
    colours = painted(positions, paint)
    order = np.random.default_rng(1).permutation(len(positions))
    straight = segmented(positions, normals, colours)
    permuted = segmented(positions[order], normals[order], colours.of(order))
    pairs = np.unique(np.stack([straight[order], permuted], axis=1), axis=0)
    assert len(pairs) == straight.max() + 1 == permuted.max() + 1 == 4


def test_scans_that_do_not_touch_are_segmented_apart():
    positions, normals = board(40)
    colours = painted(positions, np.where(positions[:, :1] > 0.1, RED, GREEN))
    alone = segmented(positions, normals, colours)
    far = positions + np.float32([1.0, 0.0, 0.0])
    both = VoxelColours(*(np.tile(q, (2, 1)) for q in (colours.low, colours.median, colours.high)))
    joined = segmented(np.concatenate([positions, far]), np.tile(normals, (2, 1)), both)
    np.testing.assert_array_equal(joined[:1600], alone)
    np.testing.assert_array_equal(joined[1600:], alone + alone.max() + 1)


@pytest.mark.parametrize("count", [0, 1, 5])
def test_very_few_voxels_are_one_segment(count):
    positions, normals = (values[:count] for values in board())
    labels = segmented(positions, normals, painted(positions, RED + 0 * positions))
    np.testing.assert_array_equal(labels, np.zeros(count))


def test_a_scrap_joins_the_neighbour_that_it_resembles():
    positions, _ = board(30)
    truth = np.where(positions[:, 0] < 0.07, 0, np.where(positions[:, 0] > 0.08, 1, 2))
    values = np.array([[0.0], [50.0], [45.0]])[truth]
    pairs = neighbour_pairs(positions)
    apart = np.abs(values[pairs[:, 0]] - values[pairs[:, 1]])[:, 0].astype(np.float32)
    least = int((truth == 2).sum()) + 1
    found = attach_scraps(truth, pairs, apart, positions, values, least)
    np.testing.assert_array_equal(found, (truth > 0).astype(int))


def test_a_scrap_that_touches_nothing_joins_the_nearest_segment():
    positions, _ = board(20)
    places = np.concatenate([positions, positions[:3] + np.float32([0.0, 0.0, 0.1])])
    labels = np.concatenate([np.zeros(400, int), np.ones(3, int)])
    pairs = neighbour_pairs(positions)
    nothing = np.zeros(len(pairs), np.float32)
    found = attach_scraps(labels, pairs, nothing, places, np.zeros((403, 1)), 60)
    assert (found == 0).all()


def test_a_million_voxels():
    positions, normals = board(1000)
    colours = painted(positions, np.where(positions[:, :1] > 2.0, RED, GREEN))
    truth = positions[:, 0] > 2.0
    np.testing.assert_array_equal(segmented(positions, normals, colours), truth)


def test_there_are_never_more_segments_than_a_map_holds():
    positions, normals = board(160)
    square = np.floor(positions / 0.0499).astype(int)
    paint = np.random.default_rng(3).uniform(0.05, 0.9, (17, 17, 3))[square[:, 0], square[:, 1]]
    labels = segmented(positions, normals, painted(positions, paint))
    assert 100 < labels.max() + 1 <= MOST_SEGMENTS
