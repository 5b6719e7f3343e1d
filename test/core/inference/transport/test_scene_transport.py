# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light that reaches the voxels of a scene past its other voxels."""

import numpy as np
import pytest

from reflest_core.inference.transport.irradiance import mean_radiance
from reflest_core.inference.transport.patch_grid import PATCHES
from reflest_core.inference.transport.reflected_patches import scene_reflection
from reflest_core.inference.transport.scene_occluders import SceneOccluders
from reflest_core.inference.transport.surface_irradiance import SurfaceSight, surface_irradiance
from reflest_core.inference.transport.visibility import Sight
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES, lobe_radiance
from reflest_core.light.completion import levels_below
from reflest_core.light.cosine_weights import cosine_weights

UP = np.float32([[0.0, 0.0, 1.0]])


def even_light(radiance=1.0):
    known = np.broadcast_to(np.float32([radiance, radiance, radiance, 1.0, 0.0]), (96, 96, 5))
    return levels_below(known)


def random_light():
    radiance = np.random.default_rng(0).random((96, 96, 5)).astype(np.float32)
    return levels_below(radiance, 0.3 * radiance[..., :3])


def ceiling(facing):
    """A square of 4 m, 1 m above the origin, whose normals have z = ``facing``."""
    step = np.arange(-2.0, 2.0, 0.05) + 0.025
    x, y = (grid.ravel() for grid in np.meshgrid(step, step))
    positions = np.stack([x, y, np.ones_like(x)], axis=1).astype(np.float32)
    normals = np.zeros_like(positions)
    normals[:, 2] = facing
    colours = np.tile(np.float32([0.5, 0.2, 0.1]), (len(x), 1))
    return SceneOccluders.of(positions, normals, colours)


def open_to(count):
    return Sight(np.ones((count, PATCHES), np.float32), np.zeros((count, PATCHES, 3)))


@pytest.mark.parametrize("facing", [-1.0, 1.0])
def test_a_ceiling_hides_the_light_whichever_side_of_it_was_scanned(facing):
    origin = np.zeros((1, 3), np.float32)
    sight = SurfaceSight.of(origin, UP, ceiling(facing))
    (found,) = surface_irradiance(even_light(), sight)
    # A square of half width a at height h hides 4 a / r atan(a / r) / pi, r^2 = a^2 + h^2.
    root = np.sqrt(5.0)
    hidden = 4.0 / np.pi * 2.0 / root * np.arctan(2.0 / root)
    shade = 1.0 if facing < 0.0 else 0.3
    expected = 1.0 - hidden + hidden * shade * np.array([0.5, 0.2, 0.1])
    np.testing.assert_allclose(found[:3], expected, atol=0.04)
    assert found[3] == pytest.approx(1.0, abs=1e-5)


def test_what_lies_behind_hides_nothing():
    sight = ceiling(-1.0).sight(np.zeros((1, 3), np.float32), -UP, cosine_weights(-UP))
    assert (sight.visible == 1.0).all()


def test_without_occluders_the_table_of_normals_agrees_with_the_sum_over_texels():
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(200, 3)).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    positions = rng.random((200, 3)).astype(np.float32)
    nothing = np.zeros((0, 3), np.float32)
    sight = SurfaceSight.of(positions, normals, SceneOccluders.of(nothing, nothing, nothing))
    found = surface_irradiance(random_light(), sight)
    np.testing.assert_allclose(found, mean_radiance(random_light(), normals), rtol=0.03)


def observations(count=30):
    rng = np.random.default_rng(2)
    normals = rng.normal(size=(count, 3))
    directions = normals + 0.5 * rng.normal(size=(count, 3))
    unit = [v / np.linalg.norm(v, axis=1, keepdims=True) for v in (normals, directions)]
    return tuple(v.astype(np.float32) for v in unit)


def test_lobes_in_the_open_are_those_of_one_object():
    normals, directions = observations()
    found = lobe_radiance(random_light(), normals, directions, open_to(30))
    np.testing.assert_allclose(
        found, lobe_radiance(random_light(), normals, directions, Sight.open(30)), rtol=1e-5
    )


def test_parts_of_a_reflection_add_up_to_its_lobe():
    light, (normals, directions) = random_light(), observations()
    roughness_of = np.arange(30) % len(ROUGHNESSES)
    sight = open_to(30)
    parts = scene_reflection(light, roughness_of, normals, directions, sight)
    lobes = lobe_radiance(light, normals, directions, sight)[np.arange(30), roughness_of, :3]
    found = parts.seen + parts.unseen.sum(axis=1)
    np.testing.assert_allclose(found, lobes, rtol=1e-4, atol=1e-6)


def test_a_mirror_under_a_ceiling_shows_its_colour():
    sight = ceiling(-1.0).sight(np.zeros((1, 3), np.float32), UP, cosine_weights(UP))
    lobes = lobe_radiance(even_light(0.0), UP, UP.copy(), sight)
    np.testing.assert_allclose(lobes[0, 0, :3] / lobes[0, 0, 0], [1.0, 0.4, 0.2], rtol=1e-4)
