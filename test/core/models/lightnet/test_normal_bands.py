# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Bands of normals: what faces down, sideways and up, each by itself."""

import numpy as np

from reflest_core.models.lightnet.normal_bands import BANDS, LEAST, NormalBands

DOWN, SIDE, UP = (0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, 0.6, 0.8)


def bands(normals, by_fill, by_whole=0.0, clipped=0.0, seen=1.0):
    """Values (V, 3) of each voxel, or one for all."""
    normals = np.array(normals, np.float32).reshape(-1, 3)
    of_channels = (
        np.array(np.broadcast_to(values, normals.shape), np.float32)
        for values in (by_fill, by_whole, clipped)
    )
    return NormalBands.of(normals, *of_channels, np.full(len(normals), seen, np.float32))


def test_means_are_of_the_voxels_that_face_there():
    by_fill = [(0.2, -0.1, -0.5), (0.4, 0.4, 0.4), (0.6, 0.6, 0.6), (0.3, 0.3, 0.3)]
    found = bands([DOWN, DOWN, SIDE, UP], by_fill, by_whole=-1.5)
    of_fill, of_whole, _ = np.split(found.of_channels, 3, axis=1)
    np.testing.assert_allclose(of_fill[0, [0, 2, 4]], [0.3, 0.6, 0.3], rtol=1e-5)
    np.testing.assert_allclose(of_fill[:, 0], [0.3, 0.15, -0.05], rtol=1e-5)
    np.testing.assert_allclose(of_whole[0, [0, 2, 4]], -1.5, rtol=1e-5)


def test_a_band_that_nothing_faces_is_zero_and_says_so():
    found = bands([UP], by_fill=0.7, seen=0.25)
    seen, shares = np.split(found.of_all, 2)
    np.testing.assert_allclose(seen, [0, 0, 0, 0, 0.25])
    np.testing.assert_allclose(shares, np.log([LEAST] * (BANDS - 1) + [1 + LEAST]), rtol=1e-5)
    assert not found.of_channels.reshape(3, 3, BANDS)[:, :, :-1].any()


def test_what_is_clipped_is_counted_by_channel():
    found = bands([SIDE, SIDE], by_fill=0.0, clipped=[(1, 0, 0), (0, 0, 1)])
    np.testing.assert_allclose(found.of_channels[:, 2 * BANDS + 2], [0.5, 0.0, 0.5])


def test_no_voxels_are_no_error():
    found = bands([], by_fill=0.0)
    assert not found.of_channels.any()
    np.testing.assert_allclose(found.of_all[BANDS:], np.log(LEAST), rtol=1e-5)
