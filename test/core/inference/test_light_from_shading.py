# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light that was not seen, or seen clipped, is found by the shading of a surface of one albedo."""

import numpy as np
import pytest

from reflest_core.inference.light_from_shading import InferredLight, infer_from_shading
from reflest_core.inference.light_prior import BRIGHT, DIM, HUE
from reflest_core.inference.transport.irradiance import incoming, mean_radiance
from reflest_core.inference.transport.light_patches import (
    LightParts,
    completed_light,
    diffuse_response,
)
from reflest_core.inference.transport.patch_grid import PATCHES, patch_directions
from reflest_core.light.completion import complete
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions

ALBEDO = np.array([0.3, 0.2, 0.1])


def normals(count=400):
    directions = np.random.default_rng(3).normal(size=(count, 3))
    return (directions / np.linalg.norm(directions, axis=1, keepdims=True)).astype(np.float32)


def sky():
    """Radiance 0.3 all around, and a lamp of 12 that covers 0.2 sr."""
    radiance = np.full((SIZE, SIZE, 3), 0.3, np.float32)
    radiance[octahedral_directions(SIZE) @ np.array([0.6, 0.0, 0.8]) > 0.97] = 12.0
    return radiance


def seen_as(radiance, coverage):
    clipped = (radiance > 1.0) * coverage[..., None]
    return ObservedLight(
        np.minimum(radiance, 1.0).astype(np.float32) * coverage[..., None],
        coverage.astype(np.float32),
        clipped.astype(np.float32),
    )


def colours_under(radiance):
    whole = seen_as(radiance, np.ones((SIZE, SIZE), np.float32))
    truth = ObservedLight(radiance, whole.coverage, np.zeros_like(whole.clipped))
    light = mean_radiance(complete(truth), normals())[:, :3]
    return np.minimum(ALBEDO * light, 1.0).astype(np.float32), light


def inferred(observed, colours, prior=BRIGHT):
    filled = complete(observed)
    found = infer_from_shading(
        diffuse_response(LightParts.of(observed, filled), incoming(cosine_weights(normals()))),
        colours,
        prior,
    )
    return filled, found


def error_of(light, truth):
    """Mean error of the logarithm of the diffuse light on the surface."""
    found = mean_radiance(light, normals())[:, :3]
    return np.abs(np.log(found / truth)).mean()


def test_a_clipped_lamp_regains_its_strength():
    radiance = sky()
    colours, truth = colours_under(radiance)
    observed = seen_as(radiance, np.ones((SIZE, SIZE), np.float32))
    filled, found = inferred(observed, colours)
    assert error_of(filled, truth) > 0.25
    assert error_of(completed_light(observed, filled, found.unseen, found.excess), truth) < 0.1
    np.testing.assert_allclose(found.albedo, ALBEDO, rtol=0.15)


def test_an_unseen_lamp_is_found_where_it_is():
    radiance = sky()
    directions = octahedral_directions(SIZE)
    colours, truth = colours_under(radiance)
    observed = seen_as(radiance, (directions[..., 2] < 0.2).astype(np.float32))
    filled, found = inferred(observed, colours)
    light = completed_light(observed, filled, found.unseen, found.excess)
    assert error_of(light, truth) < 0.5 * error_of(filled, truth)
    brightest = np.unravel_index(light.levels[0][..., 0].argmax(), (SIZE, SIZE))
    assert directions[brightest] @ np.array([0.6, 0.0, 0.8]) > 0.7


def test_unseen_light_is_expected_above_rather_than_below():
    mean, width = BRIGHT.mean[:PATCHES], BRIGHT.width[:PATCHES]
    heights = patch_directions()[:, 2]
    assert mean[heights > 0.5].min() > mean[np.abs(heights) < 0.1].max()
    assert mean[np.abs(heights) < 0.1].min() > mean[heights < -0.5].max()
    assert (DIM.mean[:PATCHES] < mean).all()
    assert (DIM.width[:PATCHES] < width).all()
    np.testing.assert_array_equal(BRIGHT.mean[PATCHES:], BRIGHT.excess[0])


def test_unseen_light_above_is_expected_bluer_than_its_fill():
    heights = patch_directions()[:, 2]
    red, green, blue = (BRIGHT.of_channel(channel) for channel in range(3))
    for less, more in ((red, green), (green, blue)):
        change = more.mean / less.mean
        assert (change[:PATCHES][heights > 0.5] > 1.1).all()
        assert (change[:PATCHES][heights < 0.0] == 1.0).all()
        np.testing.assert_allclose(more.width / less.width, change)
    assert np.prod(HUE) == pytest.approx(1.0, abs=0.01)


def test_a_table_top_is_as_light_as_its_unseen_sky_is_taken_for_dim():
    """Nothing but the prior tells the albedo of one normal under light that nobody saw."""
    up = np.tile(np.array([0.0, 0.0, 1.0], np.float32), (50, 1))
    observed = seen_as(np.minimum(sky(), 0.9), (octahedral_directions(SIZE)[..., 2] < 0.0) * 1.0)
    filled = complete(observed)
    response = diffuse_response(LightParts.of(observed, filled), incoming(cosine_weights(up)))
    bright, dim = (
        infer_from_shading(response, np.full((50, 3), 0.5, np.float32), prior).albedo
        for prior in (BRIGHT, DIM)
    )
    assert (dim > 1.5 * bright).all()


def test_highlights_on_some_voxels_hardly_matter():
    radiance = np.minimum(sky(), 0.9)
    colours, _ = colours_under(radiance)
    observed = seen_as(radiance, np.ones((SIZE, SIZE), np.float32))
    colours[::12] = np.minimum(2.5 * colours[::12], 0.99)
    np.testing.assert_allclose(inferred(observed, colours)[1].albedo, ALBEDO, rtol=0.08)


def test_parts_of_the_light_add_up_to_the_filled_light():
    observed = seen_as(sky(), (octahedral_directions(SIZE)[..., 0] < 0.1).astype(np.float32))
    filled = complete(observed)
    response = diffuse_response(
        LightParts.of(observed, filled), incoming(cosine_weights(normals()))
    )
    whole = response.seen + response.unseen.sum(axis=1)
    np.testing.assert_allclose(whole, mean_radiance(filled, normals())[:, :3], rtol=0.02)
    assert response.unseen.shape == (400, PATCHES, 3)


def test_it_is_surest_where_all_of_the_light_was_seen():
    radiance = np.minimum(sky(), 0.9)
    colours, _ = colours_under(radiance)
    whole = seen_as(radiance, np.ones((SIZE, SIZE), np.float32))
    half = seen_as(radiance, (octahedral_directions(SIZE)[..., 2] < 0.0).astype(np.float32))
    assert (inferred(whole, colours)[1].deviation < inferred(half, colours)[1].deviation).all()
    np.testing.assert_allclose(inferred(whole, colours)[1].albedo, ALBEDO, rtol=0.05)


@pytest.mark.parametrize("colour", [0.0, 1.0])
def test_black_and_clipped_surfaces_say_nothing_and_break_nothing(colour):
    observed = seen_as(sky(), np.ones((SIZE, SIZE), np.float32))
    _, found = inferred(observed, np.full((400, 3), colour, np.float32))
    assert all(np.isfinite(values).all() for values in vars(found).values())


def test_no_light_at_all_breaks_nothing():
    dark = seen_as(sky(), np.zeros((SIZE, SIZE), np.float32))
    filled, found = inferred(dark, np.full((400, 3), 0.5, np.float32))
    assert np.isfinite(completed_light(dark, filled, found.unseen, found.excess).levels[0]).all()


def light_of(albedo, factor):
    return InferredLight(
        unseen=np.full((PATCHES, 3), factor, np.float32),
        excess=np.zeros((PATCHES, 3), np.float32),
        albedo=np.full(3, albedo, np.float32),
        deviation=np.full(3, factor, np.float32),
        misfit=np.full(3, factor, np.float32),
    )


def test_the_mean_of_lights_has_the_geometric_mean_of_their_albedos():
    mean = InferredLight.mean([light_of(0.1, 1.0), light_of(0.4, 3.0)])
    np.testing.assert_allclose(mean.albedo, 0.2, rtol=1e-6)
    np.testing.assert_allclose(mean.unseen, 2.0)
    np.testing.assert_allclose(mean.deviation, 2.0)
    assert {array.dtype for array in vars(mean).values()} == {np.dtype(np.float32)}


def test_the_mean_of_one_light_is_that_light():
    only = light_of(0.1, 1.0)
    assert InferredLight.mean([only]) is only
