# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The octahedral map as a map of the sphere, and what the light map remembers of pixels."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.brdf import srgb
from reflest_core.light.light_map import SIZE, LightMap
from reflest_core.light.octahedral import (
    octahedral_directions,
    octahedral_solid_angles,
    octahedral_texel,
)

COORDINATE = st.floats(-1, 1, allow_subnormal=False)


@pytest.mark.parametrize("size", [1, 2, 24, 96])
def test_every_texel_holds_its_own_direction(size):
    for row, line in enumerate(octahedral_directions(size)):
        for column, direction in enumerate(line):
            assert octahedral_texel(*direction.astype(float), size) == (row, column)


@given(COORDINATE, COORDINATE, COORDINATE)
def test_any_direction_lies_near_its_texels_centre(x, y, z):
    length = np.sqrt(x * x + y * y + z * z)
    if length < 1e-3:
        return
    row, column = octahedral_texel(x, y, z, SIZE)
    cosine = octahedral_directions(SIZE)[row, column] @ np.array([x, y, z]) / length
    assert cosine > np.cos(np.deg2rad(3.0))


def test_solid_angles_integrate_known_functions():
    """4 pi of 1, pi of the clamped cosine about any axis, 4 pi / 3 of z squared."""
    angles, directions = octahedral_solid_angles(SIZE), octahedral_directions(SIZE)
    assert angles.sum() == pytest.approx(4 * np.pi, rel=1e-5)
    axis = np.array([0.48, -0.6, 0.64])
    assert (angles * np.maximum(directions @ axis, 0)).sum() == pytest.approx(np.pi, rel=2e-3)
    assert (angles * directions[..., 2] ** 2).sum() == pytest.approx(4 * np.pi / 3, rel=2e-3)


def test_pixels_come_back_as_mean_linear_radiance_with_their_clipping():
    light = LightMap()
    up = np.array([0.0, 0.0, 2.0], np.float32)
    light.add(np.stack([up, up, -up]), np.array([[100, 50, 0], [255, 50, 0], [9, 9, 9]], np.uint8))
    seen = light.observed()
    row, column = octahedral_texel(0.0, 0.0, 1.0, SIZE)
    expected = srgb.decode(np.array([[100, 50, 0], [255, 50, 0]]) / 255).mean(axis=0)
    np.testing.assert_allclose(seen.radiance[row, column], expected, rtol=1e-5)
    assert seen.clipped[row, column].tolist() == [0.5, 0.0, 0.0]
    assert seen.any_clipped[row, column] == 0.5
    assert seen.coverage.sum() == 2
    angles = octahedral_solid_angles(SIZE)
    below = octahedral_texel(0.0, 0.0, -1.0, SIZE)
    share = (angles[row, column] + angles[below]) / (4 * np.pi)
    assert seen.seen_share == pytest.approx(share, rel=1e-4)


def test_what_was_observed_is_a_copy():
    light = LightMap()
    before = light.observed()
    light.add(np.ones((1, 3), np.float32), np.full((1, 3), 80, np.uint8))
    assert before.coverage.sum() == 0
