# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Turning a world upright: up becomes +z and nothing else changes."""

import dataclasses

import numpy as np
import pytest

from reflest_core.inference.material import explain
from reflest_core.light.light_map import SIZE, LightMap
from reflest_core.light.octahedral import octahedral_solid_angles, octahedral_texel
from reflest_core.light.turned_light import turned_light
from reflest_core.models.hemicnn.hemisphere_images import hemisphere_images
from reflest_core.models.lightnet.features import features_of
from reflest_core.surface.upright import rotation_to_z, upright
from test.core.surfaces import sphere_surface


@pytest.mark.parametrize(
    "up", [(0, 0, 1), (0, -1, 0), (0, 0, -1), (0.6, 0.0, 0.8), (0, 0, -0.9999)]
)
def test_up_becomes_z_by_a_rotation(up):
    unit = np.array(up) / np.linalg.norm(up)
    rotation = rotation_to_z(unit)
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


def sky(directions):
    """8-bit colours of a smooth sky, bluest at the zenith and red in the east."""
    x, _, z = (directions / np.linalg.norm(directions, axis=1, keepdims=True)).T
    return np.stack([120 + 80 * x, 130 + 60 * z, 120 + 100 * z], axis=1).astype(np.uint8)


def test_a_lying_world_gives_the_features_of_the_z_up_world():
    """The light is turned with the surface, so nothing that lightnet looks at changes much."""
    swap = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], np.float32)
    directions = np.random.default_rng(3).normal(size=(200_000, 3)).astype(np.float32)
    directions = directions[directions[:, 2] > -0.6]
    standing_light, lying_light = LightMap(), LightMap()
    standing_light.add(directions, sky(directions))
    lying_light.add(directions @ swap.T, sky(directions))
    standing = dataclasses.replace(sphere_surface(), light=standing_light.observed())
    lying = dataclasses.replace(
        standing,
        positions=standing.positions @ swap.T,
        normals=standing.normals @ swap.T,
        view_centres=standing.view_centres @ swap.T,
        light=lying_light.observed(),
    )
    voxels = np.arange(0, 300, 7)
    raised = upright(lying, (0.0, -1.0, 0.0))
    expected, found, forgotten = (
        features_of(explain(*scene), voxels).diffuse_light
        for scene in ((standing, standing.light), (raised, raised.light), (raised, lying.light))
    )
    # Turning looks each texel up among the old ones: a little is lost where what was seen ends, and
    # a few voxels look into the light that is completed there.
    cost, error = np.abs(forgotten - expected), np.abs(found - expected)
    assert cost.max() > 0.05
    assert error.max() < 0.15 * cost.max()
    assert error.mean() < 0.05 * cost.mean()
    assert np.median(error) < 0.003


@pytest.mark.parametrize("up", [(0.0, -1.0, 0.0), (0.3, -0.5, -0.8)])
def test_turned_light_keeps_its_power_and_its_marks(up):
    light = LightMap()
    lamp = np.array(up, np.float32)
    rng = np.random.default_rng(1)
    light.add(lamp + 0.1 * rng.normal(size=(5000, 3)).astype(np.float32), np.full((5000, 3), 255))
    light.add(-lamp + 0.3 * rng.normal(size=(5000, 3)).astype(np.float32), np.full((5000, 3), 90))
    before = light.observed()
    after = turned_light(before, rotation_to_z(up))
    at = octahedral_texel(0.0, 0.0, 1.0, SIZE)
    assert (after.coverage[at], after.any_clipped[at]) == (1.0, 1.0)
    np.testing.assert_allclose(after.radiance[at], 1.0, rtol=1e-6)
    angles = octahedral_solid_angles(SIZE)
    for power in (
        lambda seen: seen.coverage,
        lambda seen: seen.coverage * seen.clipped[..., 1],
        lambda seen: seen.coverage * seen.radiance[..., 0],
    ):
        assert (power(after) * angles).sum() == pytest.approx(
            (power(before) * angles).sum(), rel=0.03
        )


def test_a_z_up_world_is_left_alone():
    surface = sphere_surface()
    assert upright(surface, (0.0, 0.0, 1.0)) is surface
