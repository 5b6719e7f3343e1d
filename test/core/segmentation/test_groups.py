# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which segments share their gloss."""

import numpy as np
import pytest

from reflest_core.segmentation.adjacency import neighbour_pairs
from reflest_core.segmentation.groups import Borders, gloss_groups

SHARP, BROAD, UNKNOWN = [0.0, -9.0, -30.0], [-30.0, -9.0, 0.0], [0.0, 0.0, 0.0]
WHITE, BLACK, RED = [40.0, 0.0, 0.0], [5.0, 0.0, 0.0], [20.0, 50.0, 30.0]


def grouped(labels, gloss, colours, bend=0.0):
    """Materials of the segments of a flat board (N, N), or of one whose right half is bent."""
    edge = len(labels)
    i, j = np.meshgrid(np.arange(edge), np.arange(edge), indexing="ij")
    positions = np.stack([i.ravel(), j.ravel(), 0 * i.ravel()], axis=1) * np.float32(0.005)
    angle = np.where(j.ravel() >= edge // 2, bend, 0.0)
    normals = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1).astype(np.float32)
    flat = labels.ravel()
    borders = Borders.of(flat, neighbour_pairs(positions), normals)
    return gloss_groups(borders, np.bincount(flat), np.array(gloss), np.array(colours)).tolist()


def stripes(count, edge=40):
    return np.tile(np.arange(edge) * count // edge, (edge, 1))


def test_a_checker_of_one_gloss_is_one_material():
    i, j = np.meshgrid(np.arange(40), np.arange(40), indexing="ij")
    labels = (i // 10) * 4 + j // 10
    is_white = (i // 10 + j // 10) % 2 == 0
    of_segment = [bool(is_white[labels == k][0]) for k in range(16)]
    colours = [WHITE if white else BLACK for white in of_segment]
    assert grouped(labels, [SHARP] * 16, colours) == [0] * 16


def test_squares_that_touch_at_corners_are_one_material():
    i, j = np.meshgrid(np.arange(40), np.arange(40), indexing="ij")
    labels = (i // 10 + j // 10) % 2
    assert grouped(labels, [SHARP, SHARP], [WHITE, BLACK]) == [0, 0]
    assert grouped(labels, [SHARP, BROAD], [WHITE, BLACK]) == [0, 1]


def test_two_halves_of_two_colours_stay_apart():
    assert grouped(stripes(2), [SHARP, SHARP], [WHITE, BLACK]) == [0, 1]


def test_stripes_are_one_material_unless_their_gloss_differs():
    colours = [WHITE, BLACK] * 3
    assert grouped(stripes(6), [SHARP] * 6, colours) == [0] * 6
    assert grouped(stripes(6), [SHARP, BROAD] * 3, colours) == [0, 1] * 3


@pytest.mark.parametrize(("bend", "expected"), [(0.0, [0, 0]), (1.0, [0, 1])])
def test_pieces_of_one_colour_are_joined_on_a_smooth_surface_alone(bend, expected):
    assert grouped(stripes(2), [SHARP, SHARP], [RED, RED], bend) == expected


def test_segments_without_information_agree_with_any():
    assert grouped(stripes(2), [UNKNOWN, SHARP], [RED, RED]) == [0, 0]


def test_one_segment_is_one_material():
    assert grouped(np.zeros((5, 5), int), [SHARP], [RED]) == [0]


def test_no_segments_are_no_materials():
    nothing = Borders.of(np.zeros(0, int), np.zeros((0, 2), np.int32), np.zeros((0, 3), np.float32))
    assert len(gloss_groups(nothing, np.zeros(0, int), np.zeros((0, 3)), np.zeros((0, 3)))) == 0
