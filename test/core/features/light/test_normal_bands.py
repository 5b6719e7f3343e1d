# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Bands of normals: what faces down, sideways and up, each by itself."""

import numpy as np

from reflest_core.features.light.normal_bands import BANDS, LEAST, NormalBands

DOWN, SIDE, UP = (0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, 0.6, 0.8)


def light(*radiance, seen=1.0):
    """(V, 5), grey."""
    return np.array([[value, value, value, seen, 0.0] for value in radiance], np.float32)


def bands(normals, colours, filled, whole):
    return NormalBands.of(
        np.array(normals, np.float32), np.array(colours, np.float32), filled, whole
    )


def test_ratios_are_of_the_voxels_that_face_there():
    colours = [(0.2, 0.1, 0.05), (0.4, 0.4, 0.4), (0.6, 0.6, 0.6), (0.3, 0.3, 0.3)]
    found = bands([DOWN, DOWN, SIDE, UP], colours, light(0.5, 0.5, 0.5, 0.5), light(1, 1, 1, 1))
    by_fill, by_whole, _ = np.split(found.of_channels, 3, axis=1)
    of_down = (np.log(0.4 + LEAST) + np.log(0.8 + LEAST)) / 2
    expected = [of_down, np.log(1.2 + LEAST), np.log(0.6 + LEAST)]
    np.testing.assert_allclose(by_fill[0, [0, 2, 4]], expected, rtol=1e-5)
    np.testing.assert_allclose(by_whole[0, 2], np.log(0.6 + LEAST), rtol=1e-5)
    assert by_fill[2, 0] < by_fill[1, 0] < by_fill[0, 0]


def test_a_band_that_nothing_faces_is_zero_and_says_so():
    found = bands([UP], [(0.2, 0.2, 0.2)], light(0.5, seen=0.25), light(0.5, seen=0.25))
    seen, shares = np.split(found.of_all, 2)
    np.testing.assert_allclose(seen, [0, 0, 0, 0, 0.25])
    np.testing.assert_allclose(shares, np.log([LEAST] * (BANDS - 1) + [1 + LEAST]), rtol=1e-5)
    assert not found.of_channels.reshape(3, 3, BANDS)[:, :, :-1].any()


def test_what_is_clipped_is_told_by_channel():
    found = bands([SIDE, SIDE], [(1.0, 0.3, 0.3), (0.9, 0.3, 1.0)], light(1, 1), light(1, 1))
    np.testing.assert_allclose(found.of_channels[:, 2 * BANDS + 2], [0.5, 0.0, 0.5])


def test_no_voxels_are_no_error():
    of_none, light_of_none = np.zeros((0, 3), np.float32), np.zeros((0, 5), np.float32)
    found = NormalBands.of(of_none, of_none, light_of_none, light_of_none)
    assert not found.of_channels.any()
    np.testing.assert_allclose(found.of_all[BANDS:], np.log(LEAST), rtol=1e-5)
