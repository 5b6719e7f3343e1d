# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Known colours of small surfaces."""

import numpy as np
import pytest

from reflest_core.brdf.parameters import WardParameters
from reflest_core.brdf.srgb import decode
from reflest_core.rendering.voxel_colours import (
    SCALE,
    UNKNOWN,
    estimate_colours,
    observed_colours,
    view_count_colours,
)
from reflest_core.surface.observed_surface import ObservedSurface


def surface(*observations, normal=(0.0, 0.0, 1.0)):
    """Voxels in a row, each with the given colours."""
    count = len(observations)
    return ObservedSurface(
        positions=np.array([[0.1 * n, 0.0, 0.0] for n in range(count)], np.float32),
        normals=np.tile(np.array(normal, np.float32), (count, 1)),
        offsets=np.cumsum([0, *map(len, observations)]),
        colours=np.array([c for one in observations for c in one], np.uint8).reshape(-1, 3),
        view_indices=np.zeros(sum(map(len, observations)), np.uint16),
        view_centres=np.array([[0.0, 0.0, 1.0]], np.float32),
        view_foreground=np.full((1, 3), 100.0, np.float32),
        view_background=np.full((1, 3), 100.0, np.float32),
    )


def test_the_observed_colour_is_the_mean():
    shown = observed_colours(surface([(255, 0, 10), (253, 0, 20)], [(1, 2, 3)]))
    np.testing.assert_array_equal(shown, [[254, 0, 15], [1, 2, 3]])


def test_a_voxel_that_was_not_seen_is_grey():
    shown = observed_colours(surface([(9, 9, 9)], [], [(7, 8, 9)]))
    np.testing.assert_array_equal(shown, [[9, 9, 9], [UNKNOWN] * 3, [7, 8, 9]])


def test_no_voxels_have_no_colours():
    assert observed_colours(surface()).shape == (0, 3)


def test_more_views_are_lighter_from_end_to_end_of_the_scale():
    shown = view_count_colours(np.array([1, 2, 4, 8, 16, 32, 64, 200]), most=64)
    np.testing.assert_array_equal(shown[0], SCALE[0])
    np.testing.assert_array_equal(shown[6], SCALE[-1])
    np.testing.assert_array_equal(shown[7], SCALE[-1])
    lightness = shown.astype(float) @ [0.2126, 0.7152, 0.0722]
    assert np.all(np.diff(lightness[:7]) > 5)


@pytest.mark.parametrize("most", [1, 5, 255])
def test_any_number_of_slots_has_a_scale(most):
    assert view_count_colours(np.arange(1, most + 1), most).shape == (most, 3)


def test_a_diffuse_voxel_that_faces_the_lamp_has_its_albedo():
    material = WardParameters((0.5, 0.25, 0.125), 0.0, 0.1)
    (shown,) = estimate_colours(surface([(0, 0, 0)]), material, np.array([0.0, 0.0, 2.0]))
    np.testing.assert_allclose(decode(shown / 255.0), (0.5, 0.25, 0.125), atol=0.004)


def test_slanted_light_is_weaker_by_the_cosine_and_the_back_is_dark():
    material = WardParameters((0.8, 0.8, 0.8), 0.0, 0.1)
    slanted = np.array([np.sqrt(3), 0.0, 1.0])
    (shown,) = estimate_colours(surface([(0, 0, 0)]), material, slanted)
    np.testing.assert_allclose(decode(shown / 255.0), 0.4, atol=0.004)
    (behind,) = estimate_colours(surface([(0, 0, 0)]), material, np.array([0.0, 0.0, -1.0]))
    np.testing.assert_array_equal(behind, 0)


def test_gloss_brightens_what_faces_the_lamp_alone():
    dull = WardParameters((0.2, 0.1, 0.1), 0.0, 0.1)
    glossy = WardParameters((0.2, 0.1, 0.1), 0.005, 0.1)
    for eye, is_brighter in (((0.0, 0.0, 2.0), True), ((2.0, 0.0, 2.0), False)):
        (a,), (b,) = (
            estimate_colours(surface([(0, 0, 0)]), one, np.array(eye)).astype(int)
            for one in (dull, glossy)
        )
        assert (b[0] > a[0] + 10) == is_brighter
