# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What nobody saw of the light, as bright as the object's shading asks for."""

import dataclasses

import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.environment.completed_light import LEAST_VOXELS, completed_light
from reflest_core.light.completion import complete
from reflest_core.light.light_map import SIZE, LightMap
from reflest_core.light.octahedral import octahedral_directions
from test.core.surfaces import sphere_surface, without_observations

FLOOR, SKY, ALBEDO = 0.1, 0.7, 0.5


def matte(_, normal):
    """A grey sphere between a dark floor and a bright even sky."""
    light = FLOOR + (SKY - FLOOR) * (1.0 + normal[2]) / 2.0
    return np.full(3, np.rint(srgb.encode(ALBEDO * light) * 255))


@pytest.fixture(scope="module")
def surface():
    """The sky was never seen, and little of the floor neither."""
    directions = np.random.default_rng(0).normal(size=(80_000, 3)).astype(np.float32)
    down = directions[directions[:, 2] < -0.05]
    colour = np.uint8(np.rint(srgb.encode(np.float64(FLOOR)) * 255))
    light = LightMap()
    light.add(down, np.full(down.shape, colour))
    return dataclasses.replace(sphere_surface(colour=matte), light=light.observed())


def test_a_bright_top_asks_for_a_bright_sky(surface):
    height = octahedral_directions(SIZE)[..., 2]
    sky = completed_light(surface)[height > 0.5, :3].mean()
    assert complete(surface.light).levels[0][height > 0.5, :3].mean() < 1.3 * FLOOR
    assert SKY / 1.6 < sky < SKY * 1.6


def test_what_was_seen_is_left_as_it_is(surface):
    completed, light = completed_light(surface), surface.light
    is_seen = light.coverage > 0.0
    np.testing.assert_array_equal(completed[is_seen, :3], light.radiance[is_seen])
    np.testing.assert_array_equal(completed[..., 3], light.coverage)


def test_brightness_has_no_edges(surface):
    """Apart from the rim of what was seen, neighbours differ by less than an eighth."""
    is_inside = octahedral_directions(SIZE)[..., 2] > 0.15
    bright = completed_light(surface)[..., 1]
    for axis in (0, 1):
        pairs = np.diff(bright, axis=axis) / np.delete(bright, -1, axis=axis)
        both = np.delete(is_inside, -1, axis=axis) & np.delete(is_inside, 0, axis=axis)
        assert np.abs(pairs[both]).max() < 0.125


def test_few_voxels_tell_nothing(surface):
    few = without_observations(surface, LEAST_VOXELS - 1)
    np.testing.assert_array_equal(completed_light(few), complete(surface.light).levels[0])
