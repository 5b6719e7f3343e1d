# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light features against light that has an answer in closed form."""

import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.brdf.sampling import specular_albedo
from reflest_core.inference.material import explain
from reflest_core.inference.transport.irradiance import mean_radiance
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES, lobe_radiance
from reflest_core.light.completion import complete
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.models.lightnet.features import features_of
from reflest_core.models.lightnet.light_zones import light_zones
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.surface_sample import OBSERVATIONS

GREY = np.array([0.2, 0.4, 0.1], np.float32)


def light_of(radiance, coverage=None, clipped=None):
    ones = np.ones((SIZE, SIZE), np.float32)
    coverage = ones if coverage is None else coverage.astype(np.float32)
    return ObservedLight(
        (radiance * coverage[..., None]).astype(np.float32),
        coverage,
        np.repeat((0.0 * ones if clipped is None else clipped)[..., None], 3, -1).astype(
            np.float32
        ),
    )


def uniform():
    return np.broadcast_to(GREY, (SIZE, SIZE, 3))


def random_normals(count, seed=0):
    normals = np.random.default_rng(seed).normal(size=(count, 3))
    return (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)


def test_light_that_was_all_seen_is_kept_and_averages_level_by_level():
    radiance = np.random.default_rng(1).uniform(0, 1, (SIZE, SIZE, 3))
    levels = complete(light_of(radiance)).levels
    np.testing.assert_allclose(levels[0][..., :3], radiance, rtol=1e-5)
    assert [len(level) for level in levels] == [96, 48, 24, 12, 6, 3]
    for level in levels:
        np.testing.assert_allclose(level[..., 3], 1.0, rtol=1e-5)


@pytest.mark.parametrize("share", [0.02, 0.5])
def test_unseen_directions_take_what_is_around_them(share):
    directions = octahedral_directions(SIZE)
    seen = directions[..., 0] > 1 - 2 * share
    levels = complete(light_of(uniform(), seen)).levels
    np.testing.assert_allclose(levels[0][..., :3], uniform(), rtol=1e-4)
    np.testing.assert_array_equal(levels[0][..., 3], seen)


def test_where_nothing_was_seen_there_is_no_light_and_no_error():
    nothing = complete(light_of(uniform(), np.zeros((SIZE, SIZE))))
    assert all(np.isfinite(level).all() for level in nothing.levels)
    assert (mean_radiance(nothing, random_normals(3)) == 0).all()


def test_diffuse_light_of_a_lamp_follows_the_cosine():
    lamp = octahedral_directions(SIZE)[20, 30]
    radiance = np.zeros((SIZE, SIZE, 3))
    radiance[20, 30] = 500.0
    normals = random_normals(200)
    light = mean_radiance(complete(light_of(radiance)), normals)[:, 0]
    cosine = np.maximum(normals @ lamp, 0)
    assert np.corrcoef(light, cosine)[0, 1] > 0.99
    assert light[cosine == 0].max() < 0.1 * light.max()


def test_a_lobe_under_uniform_light_reflects_its_albedo():
    """Against brute-force quadrature; 20 half vectors leave a few per cent."""
    normal = np.array([[0.36, -0.48, 0.8]], np.float32)
    tangent = np.array([0.8, 0.6, 0.0], np.float32)
    for degrees in (0.0, 40.0, 60.0):
        angle = np.deg2rad(degrees)
        towards = (np.cos(angle) * normal + np.sin(angle) * tangent).astype(np.float32)
        lobes = lobe_radiance(complete(light_of(uniform())), normal, towards)[0]
        for lobe, alpha in zip(lobes, ROUGHNESSES, strict=True):
            expected = specular_albedo(1.0, alpha, np.array([np.cos(angle)])) * GREY
            np.testing.assert_allclose(lobe[:3], expected, rtol=0.05)
            np.testing.assert_allclose(lobe[3:], [1.0, 0.0], atol=1e-5)


def test_a_sharp_lobe_looks_into_the_mirror_direction():
    radiance = np.zeros((SIZE, SIZE, 3))
    clipped = np.zeros((SIZE, SIZE))
    radiance[60:64, 60:64], clipped[60:64, 60:64] = 1.0, 1.0
    lamp = octahedral_directions(SIZE)[61:63, 61:63].mean(axis=(0, 1))
    normal = (lamp + 0.3 * random_normals(1, 3)).astype(np.float32)
    normal /= np.linalg.norm(normal)
    mirrored = 2 * (normal @ lamp)[:, None] * normal - lamp
    light = complete(light_of(radiance, clipped=clipped))
    into, beside = lobe_radiance(light, normal, mirrored), lobe_radiance(light, normal, normal)
    assert into[0, 0, 0] > 0.8
    assert into[0, 0, 4] > 0.9
    assert into[0, -1, 0] < 0.5 * into[0, 0, 0]
    assert beside[0, 0, 0] < 0.01


def test_zones_tell_the_sky_from_the_ground():
    sky = octahedral_directions(SIZE)[..., 2] > 0
    radiance = np.where(sky[..., None], 1.0, 0.25) * GREY
    zones = light_zones(complete(light_of(radiance, coverage=sky)))
    np.testing.assert_allclose(zones[:4, :3], np.broadcast_to(GREY, (4, 3)), rtol=0.05)
    np.testing.assert_allclose(zones[:, 3], [1, 1, 1, 1, 0, 0, 0, 0], atol=0.05)


def lambertian_surface(albedo, exposed_light, counts):
    voxels = len(counts)
    normals = random_normals(voxels, 5)
    offsets = np.concatenate([[0], np.cumsum(counts)])
    colour = np.rint(srgb.encode(albedo * exposed_light) * 255).astype(np.uint8)
    return ObservedSurface(
        positions=np.zeros((voxels, 3), np.float32),
        normals=normals,
        offsets=offsets,
        colours=np.broadcast_to(colour, (offsets[-1], 3)).copy(),
        view_indices=np.repeat(np.arange(voxels), counts).astype(np.uint16),
        view_centres=(2 * normals).astype(np.float32),
        view_foreground=np.zeros((voxels, 3), np.float32),
        view_background=np.zeros((voxels, 3), np.float32),
    )


def test_a_lambertian_surface_appears_as_its_albedo_wherever_it_is_seen():
    albedo = np.array([0.7, 0.3, 0.5])
    counts = np.array([3, 0, OBSERVATIONS + 20, 1])
    surface = lambertian_surface(albedo, GREY, counts)
    features = features_of(explain(surface, light_of(uniform())), np.arange(4))
    assert features.is_seen.sum(axis=1).tolist() == [3, 0, OBSERVATIONS, 1]
    np.testing.assert_allclose(
        features.apparent[features.is_seen], np.broadcast_to(albedo, (16, 3)), atol=0.02
    )
    np.testing.assert_allclose(features.cosine[features.is_seen], 1.0, atol=1e-6)
    assert (features.apparent[~features.is_seen] == 0).all()
