# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The network's statistics of a scene: the right ones, whichever way it is turned or coloured."""

import dataclasses

import numpy as np
import pytest

from reflest_core.inference import light_prior
from reflest_core.inference.material import explain
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.models.lightnet.normal_bands import BANDS
from reflest_core.models.lightnet.scene_statistics import (
    CHANNEL_STATISTICS,
    STATISTICS,
    scene_statistics,
)
from test.core.surfaces import sphere_surface

CLIPPED_BANDS = 12 + 14 + 2 * BANDS
"""Behind what the fits found, the ratios and strengths, and the bands' ratios."""


def lit_room(colour=(0.5, 0.4, 0.3)):
    """Brighter towards +x; all of it seen, none clipped."""
    strength = 0.4 + 0.3 * octahedral_directions(SIZE)[..., :1]
    ones = np.ones((SIZE, SIZE), np.float32)
    return ObservedLight(
        (strength * colour).astype(np.float32), ones, np.zeros((SIZE, SIZE, 3), np.float32)
    )


def statistics(surface, light):
    return scene_statistics(explain(surface, light))


@pytest.fixture(scope="module")
def surface():
    return sphere_surface(voxels=300, views=40)


def test_sizes_are_as_stated(surface):
    found = statistics(surface, lit_room())
    assert found.of_channels.shape == (3, CHANNEL_STATISTICS)
    assert found.of_all.shape == (STATISTICS,)


def test_clipped_colours_are_binned_by_normal_elevation(surface):
    faces_down = surface.normals[:, 2] < -0.6
    colours = surface.colours.copy()
    colours[np.repeat(faces_down, surface.observation_counts), 0] = 255
    clipped = dataclasses.replace(surface, colours=colours)
    found = (
        statistics(clipped, lit_room()).of_channels - statistics(surface, lit_room()).of_channels
    )
    clipped_bands = slice(CLIPPED_BANDS, CLIPPED_BANDS + BANDS)
    np.testing.assert_allclose(found[0, clipped_bands], [1.0] + [0.0] * (BANDS - 1), atol=1e-5)
    np.testing.assert_array_equal(found[1:, clipped_bands], 0.0)


def test_swapped_colours_swap_the_numbers(surface, monkeypatch):
    """But for the hue of unseen light, and what the order of sums does to the fit of the gloss."""
    monkeypatch.setattr(light_prior, "HUE", (1.0, 1.0, 1.0))
    swapped = dataclasses.replace(
        surface,
        colours=np.ascontiguousarray(surface.colours[:, ::-1]),
        view_foreground=surface.view_foreground[:, ::-1],
        view_background=surface.view_background[:, ::-1],
    )
    before = statistics(surface, lit_room())
    after = statistics(swapped, lit_room((0.3, 0.4, 0.5)))
    np.testing.assert_allclose(after.of_channels, before.of_channels[::-1], atol=2e-3)
    np.testing.assert_allclose(after.of_all, before.of_all, atol=2e-3)


def test_a_turned_world_gives_the_same_numbers(surface):
    """By 90 degrees about the vertical, under which the map of directions falls on itself."""
    turned = {
        name: np.stack(
            [
                -getattr(surface, name)[:, 1],
                getattr(surface, name)[:, 0],
                getattr(surface, name)[:, 2],
            ],
            axis=1,
        )
        for name in ("positions", "normals", "view_centres")
    }
    light = lit_room()
    turned_light = ObservedLight(
        *(np.ascontiguousarray(np.rot90(array, k=-1)) for array in vars(light).values())
    )
    towards = octahedral_directions(SIZE)
    brightest = np.unravel_index(turned_light.radiance[..., 0].argmax(), (SIZE, SIZE))
    assert towards[brightest][1] > 0.9
    before = statistics(surface, light)
    after = statistics(dataclasses.replace(surface, **turned), turned_light)
    np.testing.assert_allclose(after.of_channels, before.of_channels, atol=0.05)
    np.testing.assert_allclose(after.of_all, before.of_all, atol=0.05)


def without_light(light):
    return ObservedLight(0 * light.radiance, 0 * light.coverage, 0 * light.clipped)


@pytest.mark.parametrize("level", [0, 255])
def test_extremes_give_finite_numbers(surface, level):
    flat = dataclasses.replace(surface, colours=np.full_like(surface.colours, level))
    for light in (lit_room(), without_light(lit_room())):
        found = statistics(flat, light)
        assert np.isfinite(found.of_channels).all()
        assert np.isfinite(found.of_all).all()


@pytest.mark.parametrize("count", [1, 3])
def test_one_voxel_is_enough_for_finite_numbers(surface, count):
    last = int(surface.offsets[count])
    few = dataclasses.replace(
        surface,
        positions=surface.positions[:count],
        normals=surface.normals[:count],
        offsets=surface.offsets[: count + 1],
        colours=surface.colours[:last],
        view_indices=surface.view_indices[:last],
    )
    for light in (lit_room(), without_light(lit_room())):
        found = statistics(few, light)
        assert np.isfinite(found.of_channels).all()
        assert np.isfinite(found.of_all).all()
