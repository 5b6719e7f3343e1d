# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from reflest_core.fusion.poses.edge_correlation import PIXELS, correlations, zoomed


@pytest.mark.parametrize("count", [1, 10, 48])
def test_correlations_are_the_products_of_all_pairs(count):
    rng = np.random.default_rng(count)
    depth, colour = rng.normal(size=(2, count, 13, PIXELS // 4 + 3)).astype(np.float32)
    depth[:, :, 20:] = 0.0
    colour /= 100.0
    expected = np.tensordot(depth.astype(np.float64), colour, ([1, 2], [1, 2]))
    found = correlations(depth[: count // 2 + 1], colour)
    np.testing.assert_allclose(found, expected[: count // 2 + 1], rtol=1e-5, atol=1e-5)


def test_a_zoom_is_undone_about_the_middle():
    image = np.arange(35, dtype=np.float32).reshape(1, 5, 7) + 1.0
    np.testing.assert_array_equal(zoomed(image, (1.0, 1.0)), image)
    halved = zoomed(image, (2.0, 1.0))[0]
    np.testing.assert_array_equal(halved[:, 2:5], image[0][:, [1, 3, 5]])
    assert not halved[:, :1].any()
    assert not halved[:, 6:].any()
    np.testing.assert_array_equal(zoomed(image, (1.0, 0.5))[0][:, 3], image[0][[1, 2, 2, 2, 3], 3])
