# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is traced, against quadrature and geometry in numpy."""

import numpy as np
import pytest

from reflest_core.brdf import ward
from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.light.equirectangular import equirectangular_directions, radiance_from
from reflest_core.synbrdf.scenes import metering
from test.synbrdf.spheres import icosphere, joined

mitsuba_scene = pytest.importorskip("reflest_core.synbrdf.path_tracing.mitsuba_scene")
sparse_scene = pytest.importorskip("reflest_core.synbrdf.path_tracing.sparse_scene")
sight = pytest.importorskip("reflest_core.synbrdf.path_tracing.sight")
ward_bsdf = pytest.importorskip("reflest_core.synbrdf.path_tracing.ward_bsdf").ward_bsdf

RADIUS = 0.2


def scene_of(mesh, radiance, material=WardParameters((0.5, 0.5, 0.5), 0.0, 0.1)):  # noqa: B008
    return mitsuba_scene.mitsuba_scene(mesh, ward_bsdf(material), radiance)


def lit_from_the_side(height=64):
    """A smooth environment with a lobe of light about (1, 1, 1), red above and blue below."""
    towards = equirectangular_directions(height)
    lobe = 4.0 * np.exp(6.0 * (towards @ np.ones(3) / 3**0.5 - 1.0))
    colour = np.stack([1 + towards[..., 2], np.ones(towards.shape[:2]), 1 - towards[..., 2]], -1)
    return ((0.2 + lobe)[..., None] * colour).astype(np.float32)


def reflected(material, normal, towards_camera, environment):
    """Radiance by summing over the environment's texels."""
    height = len(environment)
    incident = equirectangular_directions(height).reshape(-1, 3)
    polar = (np.arange(height) + 0.5) / height * np.pi
    solid_angle = np.repeat(np.sin(polar) * np.pi**2 / height**2, 2 * height)
    tangent = np.cross(normal, [0.3, -0.5, 0.8])
    tangent /= np.linalg.norm(tangent)
    frame = np.stack([tangent, np.cross(normal, tangent), normal])
    local_in, local_out = incident @ frame.T, frame @ towards_camera
    brdf = ward.evaluate(
        np.array(material.rho_d),
        material.rho_s,
        material.alpha,
        local_in,
        np.broadcast_to(local_out, local_in.shape),
        material.variant,
    )
    weight = solid_angle * np.maximum(local_in[:, 2], 0)
    return (brdf * weight[:, None] * environment.reshape(-1, 3)).sum(axis=0)


def points_and_views(count):
    """Unit normals all over a sphere, and directions to cameras within 60 degrees of them."""
    rng = np.random.default_rng(5)
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    aside = rng.normal(size=(count, 3))
    views = normals + 0.8 * aside / np.linalg.norm(aside, axis=1, keepdims=True)
    return normals, views / np.linalg.norm(views, axis=1, keepdims=True)


@pytest.mark.parametrize("variant", WardVariant)
def test_a_sphere_shows_the_integral_of_brdf_and_light(variant):
    material = WardParameters((0.5, 0.2, 0.1), 0.3, 0.2, variant)
    environment = lit_from_the_side()
    scene = scene_of(icosphere(5, RADIUS), environment, material)
    normals, views = points_and_views(12)
    origins = (RADIUS * normals + views).astype(np.float32)
    tracer = mitsuba_scene.RadianceTracer(1 << 14, lanes=1 << 18)
    traced = tracer.trace(scene, origins, -views.astype(np.float32), seed=1)
    expected = [reflected(material, n, v, environment) for n, v in zip(normals, views, strict=True)]
    np.testing.assert_allclose(traced, expected, rtol=0.02)


def test_a_matte_sphere_in_even_light_shows_its_albedo():
    material = WardParameters((0.8, 0.4, 0.1), 0.0, 0.2)
    scene = scene_of(icosphere(4, RADIUS), np.ones((16, 32, 3), np.float32), material)
    origins = np.array([[1.0, 0.05, 0.1], [0.0, -0.1, 1.0], [0.1, 1.0, 0.0]], np.float32)
    towards = -np.eye(3, dtype=np.float32)[[0, 2, 1]]
    traced = mitsuba_scene.RadianceTracer(256, lanes=1 << 12).trace(scene, origins, towards, seed=2)
    np.testing.assert_allclose(traced, np.tile(material.rho_d, (3, 1)), rtol=0.01)


def test_rays_past_the_object_return_the_texel_of_their_direction():
    environment = lit_from_the_side(128)
    scene = scene_of(icosphere(2, 0.01, centre=(5.0, 5.0, 5.0)), environment)
    rows, columns = np.meshgrid([12, 36, 64, 100], [0, 20, 80, 160, 255], indexing="ij")
    towards = equirectangular_directions(128)[rows, columns].reshape(-1, 3).astype(np.float32)
    tracer = mitsuba_scene.RadianceTracer(4, lanes=1 << 10)
    traced = tracer.trace(scene, np.zeros_like(towards), towards, seed=3)
    # Mitsuba stretches a map's rows so that the first lies on the pole: half a texel at most.
    expected = environment[rows, columns].reshape(-1, 3)
    np.testing.assert_allclose(traced, expected, atol=0.02 * expected.max())
    np.testing.assert_allclose(radiance_from(environment, towards), expected, rtol=1e-3)


def test_more_rays_than_fit_at_once_are_traced_in_order():
    scene = scene_of(icosphere(2, 0.01, centre=(5.0, 5.0, 5.0)), lit_from_the_side(16))
    towards = equirectangular_directions(8).reshape(-1, 3).astype(np.float32)
    origins = np.zeros_like(towards)
    whole = mitsuba_scene.RadianceTracer(4, lanes=1 << 10).trace(scene, origins, towards, seed=3)
    parts = mitsuba_scene.RadianceTracer(4, lanes=1 << 7).trace(scene, origins, towards, seed=3)
    np.testing.assert_array_equal(whole, parts)
    empty = mitsuba_scene.RadianceTracer(4, lanes=1 << 7).trace(
        scene, origins[:0], towards[:0], seed=3
    )
    assert empty.shape == (0, 3)


def test_first_hits_are_distances_and_infinity():
    scene = scene_of(icosphere(5, RADIUS), np.ones((16, 32, 3), np.float32))
    origins = np.array([[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], np.float32)
    towards = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], np.float32)
    near, far = mitsuba_scene.first_hits(scene, origins, towards)
    assert near == pytest.approx(0.8, abs=1e-3)
    assert np.isinf(far)


def test_occluded_and_averted_points_are_not_paired():
    ball, screen = icosphere(4, 0.1), icosphere(4, 0.1, centre=(0.3, 0.0, 0.0))
    scene = scene_of(joined(ball, screen), np.ones((16, 32, 3), np.float32))
    positions = np.array([[0.1, 0, 0], [0, 0, 0.1], [0.3, 0, 0.1]], np.float32)
    normals = np.array([[1, 0, 0], [0, 0, 1], [0, 0, 1]], np.float32)
    centres = np.array([[1, 0, 0], [0, 0, 1], [0.1, 0.5, 0]], np.float32)
    point_of, view_of = sight.visible_pairs(scene, positions, normals, centres)
    pairs = set(zip(point_of.tolist(), view_of.tolist(), strict=True))
    # Point 0 looks at view 0, but the second ball is between; view 1 grazes it; view 2 sees its
    # normal at 90 degrees. The tops are seen from above only.
    assert pairs == {(1, 1), (2, 1)}
    centres[0] = [0.19, 0.0, 0.0]
    point_of, view_of = sight.visible_pairs(scene, positions, normals, centres)
    assert (0, 0) in set(zip(point_of.tolist(), view_of.tolist(), strict=True))


def test_mean_colours_of_object_and_background():
    images = np.array(
        [[[10, 20, 30], [30, 40, 50], [200, 100, 0]], [[1, 2, 3], [4, 5, 6], [7, 8, 9]]], np.uint8
    )
    is_foreground = np.array([[True, True, False], [False, False, False]])
    foreground, background = metering.mean_colours(images, is_foreground)
    np.testing.assert_array_equal(foreground[0], [20, 30, 40])
    assert np.isnan(foreground[1]).all()
    np.testing.assert_array_equal(background, [[200, 100, 0], [4, 5, 6]])
