# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What discs hide of the light, against form factors that are known in closed form."""

import math

import numpy as np
import pytest

from reflest_core.inference.material import explain
from reflest_core.inference.transport.irradiance import incoming, mean_radiance
from reflest_core.inference.transport.light_patches import LightParts, diffuse_response
from reflest_core.inference.transport.patch_grid import (
    EDGE,
    PATCHES,
    patches_of_texels,
    texels_of_patches,
)
from reflest_core.inference.transport.reflected_patches import reflection
from reflest_core.inference.transport.visibility import NEIGHBOURS, Occluders, Sight
from reflest_core.inference.transport.ward_lobe import lobe_radiance
from reflest_core.light.completion import complete
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions, octahedral_texels
from test.core.inference.glossy_ball import ball, seen_below
from test.core.surfaces import sphere_surface

OWN = np.array([0.4, 0.2, 0.1], np.float32)
UP = np.array([[0.0, 0.0, 1.0]], np.float32)


def spiral(count):
    """Unit vectors (count, 3), evenly over the sphere."""
    z = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    turn = np.pi * (1.0 + 5**0.5) * np.arange(count)
    ring = np.sqrt(1.0 - z**2)
    return np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=1).astype(np.float32)


def wall(height, length=40.0, spacing=0.1):
    """Discs of a wall in the plane y = 1 that stands on z = 0 and faces -y."""
    x, z = np.meshgrid(np.arange(-length, length, spacing), np.arange(spacing / 2, height, spacing))
    positions = np.stack([x.ravel(), np.ones(x.size), z.ravel()], axis=1).astype(np.float32)
    return Occluders.of(positions, np.tile(np.float32([[0.0, -1.0, 0.0]]), (x.size, 1)), OWN)


def hidden_share(occluders, position, normal=UP):
    position = np.float32([position])
    weights = cosine_weights(normal)
    return float(incoming(weights, occluders.sight(position, normal, weights)).hidden[0])


def test_a_convex_surface_hides_nothing_from_itself():
    points = spiral(400)
    sight = Occluders.of(points, points, OWN).sight(points, points, cosine_weights(points))
    assert (sight.visible > 0.97).all()
    assert sight.visible.mean() > 0.999


@pytest.mark.parametrize("height", [0.5, 1.0, 3.0])
def test_a_long_wall_hides_its_form_factor(height):
    """From a floor one unit in front of it: (1 - 1 / sqrt(1 + h^2)) / 2 (Siegel and Howell)."""
    expected = 0.5 * (1.0 - 1.0 / math.sqrt(1.0 + height**2))
    assert hidden_share(wall(height), (0.0, 0.0, 0.0)) == pytest.approx(expected, abs=0.016)


def test_a_bowl_hides_half_of_the_light_from_its_bottom():
    """Its rim is seen 45 degrees from the vertical, and sin^2 45 = 1/2."""
    points = spiral(4000)
    below = points[points[:, 2] < 0.0]
    bowl = Occluders.of(below, -below, OWN)
    assert hidden_share(bowl, (0.0, 0.0, -1.0)) == pytest.approx(0.5, abs=0.02)


def test_light_is_hidden_where_the_wall_is():
    sight = wall(3.0).sight(np.zeros((1, 3), np.float32), UP, cosine_weights(UP))
    towards, away = (
        patches_of_texels(24)[octahedral_texels(np.float32([direction]), 24)[0]]
        for direction in ([0.0, 1.0, 0.5], [0.0, -1.0, 0.5])
    )
    assert sight.visible[0, towards] < 0.2
    assert sight.visible[0, away] == 1.0


def test_a_wall_that_faces_away_hides_nothing():
    front = wall(2.0)
    back = Occluders(front.positions, -front.normals, front.areas, OWN)
    assert hidden_share(back, (0.0, 0.0, 0.0)) == 0.0


def test_a_few_voxels_hide_nothing():
    points = spiral(NEIGHBOURS)
    sight = Occluders.of(points, -points, OWN).sight(points, -points, cosine_weights(-points))
    np.testing.assert_array_equal(sight.visible, 1.0)


def half_hidden(count):
    rng = np.random.default_rng(3)
    return Sight(rng.uniform(size=(count, PATCHES)).astype(np.float32), OWN)


def even(radiance):
    whole = np.ones((SIZE, SIZE), np.float32)
    return ObservedLight(
        whole[..., None] * np.float32(radiance), whole, np.zeros((SIZE, SIZE, 3), np.float32)
    )


def test_what_hides_the_light_sends_its_own_instead():
    """In a furnace, where the object is as bright as its surroundings, nothing changes."""
    normals = spiral(50)
    light = complete(even(OWN))
    sight = half_hidden(50)
    furnace = mean_radiance(light, normals, sight)
    np.testing.assert_allclose(furnace[:, :3], np.tile(OWN, (50, 1)), rtol=1e-5)
    np.testing.assert_allclose(furnace[:, 3], 1.0, rtol=1e-5)
    dark = mean_radiance(complete(even((1e-9,) * 3)), normals, sight)
    share = 1.0 - incoming(cosine_weights(normals), sight).weights.sum(axis=1)
    np.testing.assert_allclose(dark[:, :3], share[:, None] * OWN, atol=1e-6)
    lobes = lobe_radiance(light, normals, normals, sight)
    without = lobe_radiance(light, normals, normals)
    np.testing.assert_allclose(lobes[..., :3], without[..., :3], atol=1e-5)
    # What the object sends is known by its mean colour alone: it does not count as seen.
    np.testing.assert_allclose(without[..., 3], 1.0, atol=1e-5)
    assert (lobes[..., 3].min(axis=1) < 0.9).all()


def test_parts_of_the_light_add_up_past_what_is_hidden():
    rng = np.random.default_rng(5)
    sky = rng.uniform(0.1, 1.0, (SIZE, SIZE, 3)).astype(np.float32)
    light = seen_below(sky, 0.3)
    filled = complete(light)
    sample = ball(sky, np.array([0.2, 0.2, 0.2]), 0.3, 4)
    sight = half_hidden(len(sample.normals))
    parts = diffuse_response(
        LightParts.of(light, filled), incoming(cosine_weights(sample.normals), sight)
    )
    whole = mean_radiance(filled, sample.normals, sight)[:, :3]
    np.testing.assert_allclose(parts.seen + parts.unseen.sum(axis=1), whole, rtol=0.05)
    normals, of_observations = sample.normals[sample.voxel_of], sight.of(sample.voxel_of)
    mirrored = reflection(filled, 4, normals, sample.directions, of_observations).dense
    lobes = lobe_radiance(filled, normals, sample.directions, of_observations)[:, 4, :3]
    np.testing.assert_allclose(mirrored.seen + mirrored.unseen.sum(axis=1), lobes, atol=1e-5)


def test_patches_and_texels_are_each_others_inverse():
    for size in (24, 48, 96):
        np.testing.assert_array_equal(
            patches_of_texels(size)[texels_of_patches(size)],
            np.repeat(np.arange(PATCHES)[:, None], (size // EDGE) ** 2, axis=1),
        )
        # A patch is a square of the map, so its directions lie together.
        middle = octahedral_directions(EDGE).reshape(-1, 3)[patches_of_texels(size)]
        cosines = (middle * octahedral_directions(size).reshape(-1, 3)).sum(axis=1)
        assert cosines.min() > math.cos(math.radians(40.0))


def test_an_explanation_can_do_without_it():
    surface = sphere_surface(voxels=200, views=20)
    light = even((0.5, 0.5, 0.5))
    for has_visibility, count in ((True, 200), (False, 0)):
        found = explain(surface, light, has_visibility)
        assert len(found.occluders.positions) == count
