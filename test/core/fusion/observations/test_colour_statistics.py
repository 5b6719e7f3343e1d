# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np

from reflest_core.fusion.observations.colour_statistics import foreground_background_means


def test_means_of_known_pixels():
    rgb = np.zeros((2, 3, 3), np.uint8)
    rgb[0] = [[10, 20, 30], [20, 40, 60], [255, 255, 255]]
    rgb[1] = [[0, 0, 0], [1, 2, 3], [2, 4, 6]]
    foreground = np.array([[True, True, False], [False, False, False]])
    F, B = foreground_background_means(rgb, foreground)
    np.testing.assert_array_equal(F, np.float32([15, 30, 45]))
    np.testing.assert_allclose(B, [258 / 4, 261 / 4, 264 / 4], rtol=1e-6)
    assert F.dtype == B.dtype == np.float32


def test_none_is_nan():
    rgb = np.full((4, 4, 3), 7, np.uint8)
    F, B = foreground_background_means(rgb, np.ones((4, 4), bool))
    np.testing.assert_array_equal(F, [7, 7, 7])
    assert np.isnan(B).all()
    F, B = foreground_background_means(rgb, np.zeros((4, 4), bool))
    assert np.isnan(F).all()
    np.testing.assert_array_equal(B, [7, 7, 7])


def test_large_bright_image_does_not_overflow():
    rgb = np.full((480, 640, 3), 255, np.uint8)
    F, _ = foreground_background_means(rgb, np.ones((480, 640), bool))
    np.testing.assert_array_equal(F, [255, 255, 255])
