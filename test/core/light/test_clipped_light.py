# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A channel that was not clipped is known; one that was alone is a little brighter at most."""

import numpy as np

from reflest_core.inference.transport.irradiance import incoming
from reflest_core.inference.transport.light_patches import LightParts, diffuse_response
from reflest_core.inference.transport.reflected_patches import reflection
from reflest_core.light.completion import PARTLY, complete, excess_shape
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.light.light_map import SIZE, LightMap

UP = np.array([[0.0, 0.0, 1.0]], np.float32)


def sky(colour):
    """Everywhere of this 8-bit colour."""
    light = LightMap()
    directions = np.random.default_rng(1).normal(size=(200_000, 3)).astype(np.float32)
    light.add(directions, np.tile(np.array(colour, np.uint8), (len(directions), 1)))
    return light.observed()


def test_each_channel_has_its_own_share():
    light = sky((90, 200, 255))
    seen = light.coverage > 0.0
    shape = excess_shape(light)
    np.testing.assert_allclose(shape[seen], np.tile([0.0, 0.0, PARTLY], (seen.sum(), 1)))
    assert not shape[~seen].any()
    np.testing.assert_array_equal(excess_shape(sky((255, 255, 255)))[seen], 1.0)


def test_half_clipped_texels_hold_half():
    light = LightMap()
    up = np.tile(UP, (2, 1))
    light.add(up, np.array([[255, 255, 255], [255, 9, 9]], np.uint8))
    (shape,) = excess_shape(light.observed())[light.count > 0.0]
    np.testing.assert_allclose(shape, [0.5 + 0.5 * PARTLY, 0.5, 0.5])


def test_surfaces_answer_by_channel():
    """Of a sky that left the range in blue, red and green are known."""
    light = sky((90, 200, 255))
    filled = complete(light)
    shaded = diffuse_response(LightParts.of(light, filled), incoming(cosine_weights(UP)))
    mirrored = reflection(filled, 4, UP, UP).dense
    for parts in (shaded, mirrored):
        excess = parts.excess[0].sum(axis=0)
        assert (excess[:2] == 0.0).all()
        np.testing.assert_allclose(excess[2], PARTLY, rtol=0.05)
    assert filled.levels[0].shape == (SIZE, SIZE, 5)
