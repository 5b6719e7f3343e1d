# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One convention: what a person at the centre sees, unmirrored."""

import numpy as np
import pytest

from reflest_core.light.equirectangular import (
    equirectangular_directions,
    equirectangular_solid_angles,
    nearest_radiance,
    radiance_from,
)


@pytest.mark.parametrize(
    ("direction", "column"), [((1, 0, 0), 32), ((0, 1, 0), 16), ((0, -1, 0), 48)]
)
def test_left_of_the_middle_lies_what_is_left_of_x(direction, column):
    directions = equirectangular_directions(32)
    beside = directions[15:17, column - 1 : column + 1].mean(axis=(0, 1))
    np.testing.assert_allclose(beside / np.linalg.norm(beside), direction, atol=1e-12)


def test_up_is_in_the_first_row():
    assert equirectangular_directions(32)[0, :, 2].min() > 0.99


@pytest.mark.parametrize("look_up", [radiance_from, nearest_radiance])
def test_looking_up_a_pixels_own_direction_gives_the_pixel(look_up):
    environment = np.random.default_rng(3).random((16, 32, 3)).astype(np.float32)
    directions = equirectangular_directions(16).reshape(-1, 3)
    found = look_up(environment, directions).reshape(environment.shape)
    np.testing.assert_allclose(found, environment, atol=1e-5)


def test_nearest_and_bilinear_agree_on_a_smooth_environment():
    environment = (2.0 + equirectangular_directions(128)).astype(np.float32)
    directions = np.random.default_rng(4).normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    np.testing.assert_allclose(radiance_from(environment, directions), 2 + directions, atol=2e-3)
    np.testing.assert_allclose(nearest_radiance(environment, directions), 2 + directions, atol=0.03)


def test_the_seam_is_mixed_from_both_edges():
    environment = np.zeros((8, 16, 1), np.float32)
    environment[:, 0], environment[:, -1] = 2.0, 4.0
    assert radiance_from(environment, np.array([[-1.0, 0.0, 0.0]]))[0, 0] == pytest.approx(3.0)


def test_solid_angles_sum_to_the_sphere():
    assert equirectangular_solid_angles(32).sum() * 64 == pytest.approx(4 * np.pi)
