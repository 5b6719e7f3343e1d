# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Texels of faces, values between voxels, and what lies beside the charts."""

import numpy as np
import pytest

from reflest_core.export.bake import covered_texels, filled, interpolated


def test_a_square_of_two_faces_covers_each_texel_once():
    uv = np.array([[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]], np.float32)
    texels, face, weights = covered_texels(uv, np.array([[0, 1, 2], [0, 2, 3]], np.int32), 10)
    # Centres lie at .05, .15, ...: those of 2 and 7 on the very edge.
    rows, columns = np.divmod(np.unique(texels), 10)
    assert set(rows) == set(columns) == set(range(2, 8))
    assert weights.sum(axis=1) == pytest.approx(1.0)
    assert set(face) == {0, 1}


def test_barycentric_coordinates_give_the_texels_place_back():
    generator = np.random.default_rng(0)
    uv = generator.random((30, 2)).astype(np.float32)
    faces = generator.permutation(30).reshape(10, 3).astype(np.int32)
    texels, face, weights = covered_texels(uv, faces, 64)
    found = np.einsum("tk,tkc->tc", weights, uv[faces[face]])
    rows, columns = np.divmod(texels, 64)
    np.testing.assert_allclose(found[:, 0], (columns + 0.5) / 64, atol=1e-6)
    np.testing.assert_allclose(found[:, 1], 1 - (rows + 0.5) / 64, atol=1e-6)


def test_a_face_without_area_covers_nothing():
    uv = np.array([[0.1, 0.1], [0.5, 0.5], [0.9, 0.9]], np.float32)
    texels, _, _ = covered_texels(uv, np.array([[0, 1, 2]], np.int32), 16)
    assert len(texels) == 0


def test_values_are_interpolated_within_a_label():
    positions = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0.1, 0]], np.float32)
    values = np.array([[0.0], [1.0], [9.0]], np.float32)
    labels = np.array([0, 0, 1], np.int32)
    places = np.array([[0, 0, 0], [0.5, 0, 0], [0.5, 0, 0]], np.float32)
    wanted = np.array([0, 0, 1], np.int32)
    found = interpolated(places, wanted, positions, labels, values, 0.7)
    assert found[0, 0] < 0.3
    assert found[1, 0] == pytest.approx(0.5)
    assert found[2, 0] == pytest.approx(9.0)


def test_unknown_values_are_passed_over():
    positions = np.array([[0, 0, 0], [1, 0, 0]], np.float32)
    labels, places = np.zeros(2, np.int32), np.zeros((1, 3), np.float32)
    some = interpolated(
        places, labels[:1], positions, labels, np.array([[np.nan], [2.0]], np.float32), 0.1
    )
    assert some[0, 0] == pytest.approx(2.0)
    none = interpolated(
        places, labels[:1], positions, labels, np.full((2, 1), np.nan, np.float32), 0.1
    )
    assert np.isnan(none).all()


def test_texels_beside_the_charts_take_the_nearest_colour():
    colours = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], np.float32)
    image = filled(np.array([0, 15]), colours, 4)
    assert image.shape == (4, 4, 3)
    assert image[0, 0].tolist() == [255, 0, 0]
    assert image[0, 1].tolist() == [255, 0, 0]
    assert image[3, 2].tolist() == [0, 255, 0]


def test_colours_are_srgb_encoded():
    image = filled(np.array([0]), np.array([[0.5, 0.0, 1.0]], np.float32), 1)
    assert image[0, 0].tolist() == [188, 0, 255]
