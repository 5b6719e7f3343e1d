# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The swatch sphere: a white furnace, a light's known radiance, the highlight's place."""

import math

import numpy as np
import pytest

from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.light.equirectangular import equirectangular_directions
from reflest_core.rendering.environments import irradiance, studio
from reflest_core.rendering.sphere import render_environment, render_point_light, tone_map

MATTE = WardParameters((0.6, 0.4, 0.2), 0.0, 0.1)


def test_a_matte_sphere_in_a_white_furnace_shows_its_albedo():
    image = render_environment(MATTE, np.ones((64, 128, 3), np.float32), 32)
    np.testing.assert_allclose(image[16, 16], [0.6, 0.4, 0.2], rtol=2e-3)
    np.testing.assert_allclose(image[0, 0], 1)


def test_a_smooth_glossy_sphere_in_a_white_furnace_adds_its_strength():
    glossy = WardParameters((0.0, 0.0, 0.0), 0.5, 0.01, WardVariant.BOUNDED_2010)
    image = render_environment(glossy, np.ones((64, 128, 3), np.float32), 32)
    np.testing.assert_allclose(image[16, 16], 0.5, rtol=1e-2)


def test_a_mirror_like_sphere_reflects_what_is_behind_the_camera():
    environment = np.zeros((64, 128, 3), np.float32)
    environment[24:40, 88:104] = (0, 5, 0)  # azimuth -pi/2: the camera's side, on the horizon
    sphere = WardParameters((0.0, 0.0, 0.0), 1.0, 0.01)
    image = render_environment(sphere, environment, 64)
    assert image[32, 32, 1] > 3
    assert image[32, 6, 1] < 0.1


def test_point_light_head_on_is_albedo_plus_the_lobe():
    glossy = WardParameters((0.6, 0.4, 0.2), 0.1, 0.2)
    image = render_point_light(glossy, (0, -1, 0), 65)
    expected = np.array([0.6, 0.4, 0.2]) + 0.1 / (4 * 0.2**2)
    np.testing.assert_allclose(image[32, 32], expected, rtol=1e-6)
    assert not image[0, 0].any()


def test_the_highlight_follows_the_light():
    glossy = WardParameters((0.1, 0.1, 0.1), 0.2, 0.05)
    for side in (-1, 1):
        image = render_point_light(glossy, (side, -1, 0), 64)
        column = np.unravel_index(image[..., 0].argmax(), (64, 64))[1]
        # The half vector lies at 22.5 degrees: sin(22.5) of the radius from the middle.
        assert column == pytest.approx(31.5 + side * 32 * 0.95 * math.sin(math.pi / 8), abs=1.5)


def test_studio_is_deterministic_positive_and_brighter_above():
    environment = studio()
    np.testing.assert_array_equal(environment, studio())
    assert (environment > 0).all()
    up, down = irradiance(environment, np.array([[0.0, 0, 1], [0, 0, -1]]))
    assert up.mean() > down.mean()


def test_the_sphere_stands_before_the_background_as_an_onlooker_sees_it():
    """A mirror ball shows on its right side what lies to the right, as does the background."""
    right = equirectangular_directions(64)[..., 0] > 0.0  # +x: the camera at -y looks along +y
    environment = np.where(right[..., None], [5.0, 0.0, 0.0], [0.0, 5.0, 0.0]).astype(np.float32)
    image = render_environment(WardParameters((0.0, 0.0, 0.0), 1.0, 0.01), environment, 64)
    assert image[32, 63].tolist() == [5, 0, 0]
    assert image[32, 0].tolist() == [0, 5, 0]
    assert image[32, 48].argmax() == 0
    assert image[32, 16].argmax() == 1


def test_tone_map_clips_and_encodes():
    image = tone_map(np.array([[[0.0, 0.18, 7.0]]]))
    assert image.dtype == np.uint8
    assert image[0, 0].tolist() == [0, 118, 255]
