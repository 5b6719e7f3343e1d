# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Exposure inferred from the background, and what a map gains from frames of different exposure."""

import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.light.exposure_gain import LEAST_TEXELS, SAME_EXPOSURE
from reflest_core.light.light_map import LightMap
from reflest_core.light.octahedral import octahedral_texels

LAMP = np.array([0.0, 0.6, 0.8])


def radiance(directions):
    """A room of smooth colours, 0.05 to 0.6, and a lamp of 5 that is 24 degrees across."""
    x, y, z = directions.T
    room = 0.3 + 0.25 * np.stack([np.sin(5 * x) * y, np.cos(4 * y) * z, np.sin(3 * z) * x], axis=1)
    return np.where((directions @ LAMP > np.cos(np.radians(12.0)))[:, None], 5.0, room)


def pixels(towards, exposure=1.0, seed=0, noise=0.0):
    """Directions and 8-bit colours of a view some 60 degrees wide."""
    rng = np.random.default_rng(seed)
    directions = np.asarray(towards) + 0.5 * rng.uniform(-1, 1, (3000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    encoded = srgb.encode(radiance(directions) * exposure) * 255.0 + noise * rng.normal(
        size=(3000, 3)
    )
    eight_bit = np.clip(np.rint(encoded), 0, 255).astype(np.uint8)
    return directions.astype(np.float32), eight_bit


def around(number):
    """Twelve views about z."""
    angle = number * np.pi / 6.0
    return np.array([np.cos(angle), np.sin(angle), 0.3])


def test_the_gain_undoes_the_exposure():
    light = LightMap()
    exposures = [1.0, 0.9, 0.7, 1.2, 1.5, 0.6, 0.3, 0.25, 0.5, 0.8, 1.0, 1.1]
    for number, exposure in enumerate(exposures):
        gain = light.add_frame(*pixels(around(number), exposure, seed=number))
        assert abs(np.log2(gain * exposure)) < 2.5 * SAME_EXPOSURE
    seen = light.observed()
    row_column = octahedral_texels(np.array([around(3), around(9)]), len(seen.coverage))
    there = seen.radiance.reshape(-1, 3)[row_column]
    unit = np.stack([around(3), around(9)])
    unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    np.testing.assert_allclose(there, radiance(unit), rtol=0.1)


def test_a_locked_exposure_gives_the_map_of_plain_sums():
    gathered, plain = LightMap(), LightMap()
    for number in range(12):
        directions, colours = pixels(around(number), seed=number, noise=2.0)
        assert gathered.add_frame(directions, colours) == 1.0
        plain.add(directions, colours)
    for name, array in plain.arrays.items():
        np.testing.assert_array_equal(gathered.arrays[name], array)


def test_a_darker_frame_shows_what_the_lamp_really_is():
    light = LightMap()
    light.add_frame(*pixels(LAMP))
    texel = octahedral_texels(LAMP[None], 96)[0]
    before = light.observed()
    assert before.any_clipped.ravel()[texel] == 1.0
    np.testing.assert_allclose(before.radiance.reshape(-1, 3)[texel], 1.0)
    light.add_frame(*pixels(LAMP, 0.15, seed=1))
    after = light.observed()
    assert after.any_clipped.ravel()[texel] == 0.0
    np.testing.assert_allclose(after.radiance.reshape(-1, 3)[texel], 5.0, rtol=0.05)
    # The bright exposure comes back, and knows less: nothing of it is believed there.
    light.add_frame(*pixels(LAMP, seed=2))
    again = light.observed()
    np.testing.assert_array_equal(
        again.radiance.reshape(-1, 3)[texel], after.radiance.reshape(-1, 3)[texel]
    )
    assert again.any_clipped.ravel()[texel] == 0.0


def test_the_rim_of_a_lamp_is_not_darkened_by_the_frame_that_clipped_it():
    """A texel half lamp, half wall: its mean is that of the dark frame, not of the walls alone."""
    up = np.tile(np.array([[0.0, 0.0, 1.0]], np.float32), (10, 1))
    grey = np.uint8(np.rint(srgb.encode(np.float64(0.2)) * 255))
    bright = np.full((10, 3), grey)
    bright[:5] = 255
    dark = np.full((10, 3), np.uint8(np.rint(srgb.encode(np.float64(0.2 / 8)) * 255)))
    dark[:5] = np.uint8(np.rint(srgb.encode(np.float64(4.0 / 8)) * 255))
    for order in ([(bright, 1.0), (dark, 8.0)], [(dark, 8.0), (bright, 1.0)]):
        light = LightMap()
        for colours, gain in order:
            light.add(up, colours, gain)
        seen = light.observed()
        assert seen.radiance.max() == pytest.approx(2.1, rel=0.03)
        assert seen.clipped.max() == 0.0


def test_too_little_in_common_keeps_the_gain_of_the_frame_before():
    light = LightMap()
    light.add_frame(*pixels(around(0)))
    light.add_frame(*pixels(around(1), 0.5))
    before = light.gain
    assert before == pytest.approx(2.0, rel=0.03)
    few = slice(0, LEAST_TEXELS // 2)
    directions, colours = pixels(around(1), 0.1)
    assert light.add_frame(directions[few], colours[few]) == before
    assert light.add_frame(*pixels(around(7), 0.1)) == before
    assert light.add_frame(np.empty((0, 3), np.float32), np.empty((0, 3), np.uint8)) == before


def test_what_moves_about_is_no_exposure():
    """Every direction shows another colour than before, none of them systematically brighter."""
    rng = np.random.default_rng(5)
    directions, _ = pixels(around(0))
    light = LightMap()
    for _ in range(20):
        colours = np.repeat(rng.integers(40, 200, (3000, 1), np.uint8), 3, axis=1)
        assert light.add_frame(directions, colours) == 1.0


def test_a_gain_is_bounded():
    light = LightMap()
    light.add(*pixels(around(0)), 4096.0)
    assert light.add_frame(*pixels(around(0))) == 64.0


def test_darkness_says_nothing():
    light = LightMap()
    directions, _ = pixels(around(0))
    light.add(directions, np.full((3000, 3), 2, np.uint8))
    assert light.add_frame(directions, np.full((3000, 3), 9, np.uint8)) == 1.0


def test_where_parallax_blurs_the_background_the_objects_voxels_tell():
    rng = np.random.default_rng(6)
    directions, _ = pixels(around(0))

    def anything():
        return np.repeat(rng.integers(40, 200, (3000, 1), np.uint8), 3, axis=1)

    def agreed():
        return rng.normal(0.7, 0.1, 200)

    light = LightMap()
    light.add(directions, anything())
    assert np.log2(light.add_frame(directions, anything(), agreed)) == pytest.approx(0.7, abs=0.05)
    for doubtful in (
        lambda: rng.normal(0.0, 2.0, 200),
        lambda: rng.normal(4.0, 0.1, 200),
        lambda: rng.normal(0.0, 0.1, LEAST_TEXELS - 1),
    ):
        before = light.gain
        assert light.add_frame(directions, anything(), doubtful) == before


def test_a_clear_background_asks_nobody():
    def never():
        raise AssertionError

    light = LightMap()
    for exposure in (1.0, 0.5):
        light.add_frame(*pixels(around(0), exposure), never)
    assert light.gain == pytest.approx(2.0, rel=0.03)
