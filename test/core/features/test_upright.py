# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Turning a world upright: up becomes +z and nothing else changes."""

import dataclasses

import numpy as np
import pytest

from reflest_core.features.hemisphere import hemisphere_images
from reflest_core.features.upright import _shortest_rotation_to_z, upright
from test.core.surfaces import sphere_surface


@pytest.mark.parametrize(
    "up", [(0, 0, 1), (0, -1, 0), (0, 0, -1), (0.6, 0.0, 0.8), (0, 0, -0.9999)]
)
def test_up_becomes_z_by_a_rotation(up):
    unit = np.array(up) / np.linalg.norm(up)
    rotation = _shortest_rotation_to_z(unit)
    np.testing.assert_allclose(rotation @ unit, [0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(rotation) == pytest.approx(1)


def test_a_camera_frame_world_gives_the_images_of_the_z_up_world():
    surface = sphere_surface()
    swap = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], np.float32)  # z up to y down
    lying = dataclasses.replace(
        surface,
        positions=surface.positions @ swap.T,
        normals=surface.normals @ swap.T,
        view_centres=surface.view_centres @ swap.T,
    )
    voxels = np.arange(0, 300, 7)
    expected = hemisphere_images(surface, voxels)
    assert (hemisphere_images(upright(lying, (0.0, -1.0, 0.0)), voxels) == expected).mean() > 0.995
    assert (hemisphere_images(lying, voxels) == expected).mean() < 0.9


def test_a_z_up_world_is_left_alone():
    surface = sphere_surface()
    assert upright(surface, (0.0, 0.0, 1.0)) is surface
