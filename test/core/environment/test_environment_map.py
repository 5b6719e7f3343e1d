# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The equirectangular map: where a direction lands, what of it was seen, how much light."""

import dataclasses

import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.environment.environment_map import environment_map
from reflest_core.environment.picture import (
    DIMMED,
    LOWER_BOUND,
    SEEN,
    UNSEEN,
    coverage_codes,
    tone_mapped,
)
from reflest_core.light.equirectangular import (
    equirectangular_directions,
    equirectangular_solid_angles,
)
from reflest_core.light.light_map import SIZE, LightMap, ObservedLight
from reflest_core.light.octahedral import (
    octahedral_directions,
    octahedral_solid_angles,
    octahedral_texel,
    octahedral_texels,
)
from test.core.export.lights import around

HEIGHT = 64


def everywhere(radiance):
    """A light of which everything was seen."""
    return ObservedLight(
        np.asarray(radiance, np.float32),
        np.ones((SIZE, SIZE), np.float32),
        np.zeros((SIZE, SIZE, 3), np.float32),
    )


@pytest.mark.parametrize(
    ("direction", "row", "column"),
    [
        ((1.0, 0.0, 0.0), 0.5, 0.5),
        ((0.0, 1.0, 0.0), 0.5, 0.25),
        ((0.0, -1.0, 0.0), 0.5, 0.75),
        ((1.0, 0.0, 1.0), 0.25, 0.5),
        ((1.0, 1.0, -np.sqrt(2.0)), 0.75, 0.375),
        ((-1.0, 1e-3, 0.0), 0.5, 0.0),
    ],
)
def test_a_lamp_lands_where_the_convention_says(direction, row, column):
    lamp = octahedral_directions(SIZE) @ (np.array(direction) / np.linalg.norm(direction))
    light = everywhere(np.repeat((lamp > np.cos(np.deg2rad(4.0)))[..., None], 3, axis=-1))
    bright = environment_map(around(light), HEIGHT).radiance[..., 0]
    turn = np.exp(2j * np.pi * (np.arange(2 * HEIGHT) + 0.5) / (2 * HEIGHT))
    rows = (np.arange(HEIGHT) + 0.5) / HEIGHT
    assert (bright.sum(axis=1) @ rows) / bright.sum() == pytest.approx(row, abs=0.01)
    found = np.angle(bright.sum(axis=0) @ turn) / (2 * np.pi)
    assert np.abs(np.exp(2j * np.pi * (found - column)) - 1) < 0.05


def test_the_zenith_is_the_first_row():
    up = octahedral_directions(SIZE)[..., 2:] > np.cos(np.deg2rad(5.0))
    bright = environment_map(around(everywhere(np.repeat(up, 3, axis=-1))), HEIGHT).radiance
    assert (bright[0] > 0.9).all()
    assert not bright[HEIGHT // 2 :].any()


def test_light_is_neither_lost_nor_won():
    rng = np.random.default_rng(2)
    light = everywhere(rng.uniform(0, 1, (SIZE, SIZE, 3)))
    given = (light.radiance * octahedral_solid_angles(SIZE)[..., None]).sum(axis=(0, 1))
    angles = equirectangular_solid_angles(HEIGHT)
    assert angles.sum() * 2 * HEIGHT == pytest.approx(4 * np.pi)
    there = (environment_map(around(light), HEIGHT).radiance * angles[..., None]).sum(axis=(0, 1))
    np.testing.assert_allclose(there, given, rtol=2e-3)


def test_what_was_seen_is_kept_and_what_was_not_is_marked():
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(60000, 3)).astype(np.float32)
    directions[:, 0] = np.abs(directions[:, 0])
    colours = np.full((len(directions), 3), 120, np.uint8)
    colours[directions[:, 2] > np.abs(directions[:, 0]) + np.abs(directions[:, 1])] = 255
    light = LightMap()
    light.add(directions, colours)
    environment = environment_map(around(light.observed()), HEIGHT)
    codes = coverage_codes(environment)
    middle, left_edge = HEIGHT, 0
    assert codes[HEIGHT // 2, middle] == SEEN
    assert codes[4, middle] == LOWER_BOUND
    assert codes[HEIGHT // 2, left_edge] == UNSEEN
    grey = srgb.decode(np.float64(120 / 255))
    np.testing.assert_allclose(environment.radiance[HEIGHT // 2, middle], grey, rtol=1e-4)
    assert environment.radiance[HEIGHT // 2, left_edge].min() > 0.5 * grey
    picture = tone_mapped(environment)
    np.testing.assert_array_equal(picture[HEIGHT // 2, middle], 120)
    assert picture[HEIGHT // 2, left_edge].max() <= np.ceil(DIMMED * 255)


def test_nothing_seen_is_black_and_said_to_be_unseen():
    environment = environment_map(around(LightMap().observed()), HEIGHT)
    assert environment.radiance.shape == (HEIGHT, 2 * HEIGHT, 3)
    for array in dataclasses.astuple(environment):
        assert not array.any()
    assert not coverage_codes(environment).any()


def test_directions_are_looked_up_as_one_by_one():
    directions = equirectangular_directions(16).reshape(-1, 3)
    expected = [np.dot(octahedral_texel(*one, SIZE), (SIZE, 1)) for one in directions]
    np.testing.assert_array_equal(octahedral_texels(directions, SIZE), expected)
