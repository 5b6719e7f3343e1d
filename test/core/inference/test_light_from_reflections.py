# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A glossy surface shows light that no camera saw, and so its own albedo."""

import dataclasses

import numpy as np

from reflest_core.inference.gloss.gloss_fit import GlossFit
from reflest_core.inference.light_from_reflections import infer_light_by_gloss
from reflest_core.inference.light_from_shading import infer_from_shading
from reflest_core.inference.transport.irradiance import incoming, mean_radiance
from reflest_core.inference.transport.light_patches import (
    LightParts,
    completed_light,
    diffuse_response,
)
from reflest_core.inference.transport.reflected_patches import reflection
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES, lobe_radiance
from reflest_core.light.completion import complete
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.surface.surface_sample import SurfaceSample
from test.core.inference.glossy_ball import ball, known, seen_below

ALBEDO = np.array([0.12, 0.08, 0.05])
ROUGHNESS = 4
OF_A_SIDE = 60
"""Voxels, each seen once."""


def sky():
    """Dim ground and horizon, with a broad bright window high up."""
    directions = octahedral_directions(SIZE)
    radiance = np.full((SIZE, SIZE, 3), 0.08, np.float32)
    radiance[directions @ np.array([0.5, 0.0, 0.87]) > 0.85] = 1.5
    return radiance


def gloss_of(rho_s):
    """A fit that is sure of the gloss."""
    misfit = np.ones(len(ROUGHNESSES), np.float32)
    misfit[ROUGHNESS] = 0.1
    whole = np.full(len(ROUGHNESSES), rho_s, np.float32)
    return GlossFit(whole, whole * 0.01, misfit, whole)


def explained(rho_s):
    sample = ball(sky(), ALBEDO, rho_s, ROUGHNESS)
    light = seen_below(sky(), 0.3)
    filled = complete(light)
    response = diffuse_response(
        LightParts.of(light, filled), incoming(cosine_weights(sample.normals))
    )
    mirrored = reflection(filled, ROUGHNESS, sample.normals[sample.voxel_of], sample.directions)
    start = np.full(3, 0.3, np.float32)
    (whole,) = infer_light_by_gloss(sample, response, mirrored, gloss_of(rho_s), start)
    return sample, light, filled, response, whole


def test_what_was_seen_and_what_was_not_add_up_to_the_lobe():
    seen = seen_below(sky(), 0.3)
    light = complete(seen)
    sample = ball(sky(), ALBEDO, 0.3, ROUGHNESS)
    normals = sample.normals[sample.voxel_of]
    for roughness in (0, ROUGHNESS, 7):
        parts = reflection(light, roughness, normals, sample.directions).dense
        lobes = lobe_radiance(light, normals, sample.directions)[:, roughness]
        np.testing.assert_allclose(parts.seen + parts.unseen.sum(axis=1), lobes[:, :3], atol=1e-5)
    assert (parts.unseen.sum(axis=(1, 2)) > 0.0).any()
    assert (parts.seen.sum(axis=1) > 0.0).any()


def test_clipped_directions_answer_to_an_excess():
    clipped = np.zeros((SIZE, SIZE, 3), np.float32)
    clipped[octahedral_directions(SIZE)[..., 2] > 0.8] = 1.0
    whole = ObservedLight(np.ones_like(clipped), np.ones((SIZE, SIZE), np.float32), clipped)
    up = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]], np.float32)
    parts = reflection(complete(whole), 0, up, up).dense
    np.testing.assert_allclose(parts.excess[0].sum(axis=0), 1.0, atol=0.02)
    assert parts.excess[1].sum() == 0.0
    assert not parts.unseen.any()


def test_gloss_determines_the_albedo_under_unseen_light():
    sample, _, _, response, whole = explained(0.3)
    np.testing.assert_allclose(whole.albedo, ALBEDO, rtol=0.25)
    darkest = np.full((len(sample.normals), 3), 1.0, np.float32)
    np.minimum.at(darkest, sample.voxel_of, sample.colours)
    shading_alone = infer_from_shading(response, darkest)
    error, without = (
        np.abs(np.log(found.albedo / ALBEDO)).max() for found in (whole, shading_alone)
    )
    assert error < 0.5 * without


def test_the_unseen_window_is_found():
    sample, light, filled, _, whole = explained(0.3)
    truth = mean_radiance(complete(known(sky())), sample.normals)[:, :3]
    before, after = (
        np.abs(np.log(mean_radiance(pyramid, sample.normals)[:, :3] / truth)).mean()
        for pyramid in (filled, completed_light(light, filled, whole.unseen, whole.excess))
    )
    assert after < 0.4 * before


def test_every_second_observation_says_nearly_as_much():
    sample, _, filled, response, whole = explained(0.3)
    half = sample.every(2)
    np.testing.assert_array_equal(half.spread(half.colours)[half.voxel_of, half.slot], half.colours)
    mirrored = reflection(filled, ROUGHNESS, half.normals[half.voxel_of], half.directions)
    (found,) = infer_light_by_gloss(half, response, mirrored, gloss_of(0.3), whole.albedo)
    assert len(half.colours) == (len(sample.colours) + 1) // 2
    np.testing.assert_allclose(found.albedo, whole.albedo, rtol=0.1)


def test_without_gloss_it_says_that_it_is_less_sure():
    assert (explained(0.0)[-1].deviation > 1.5 * explained(0.3)[-1].deviation).all()


def test_what_is_clipped_asks_for_no_less_light():
    """Matte, its lower side under seen light, its upper side clipped: so bright must the sky be."""
    ground = np.full((SIZE, SIZE, 3), 0.1, np.float32)
    light = seen_below(ground, 0.0)
    filled = complete(light)
    sides = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]], np.float32)
    normals = np.repeat(sides, OF_A_SIDE, axis=0)
    voxels = np.arange(2 * OF_A_SIDE)
    is_upper = np.repeat(normals[:, 2:] > 0.0, 3, axis=1)
    whole = SurfaceSample(
        voxels,
        normals,
        voxels,
        np.zeros_like(voxels),
        normals,
        np.where(is_upper, np.float32(1.0), np.float32(0.05)),
        is_upper,
    )
    above = []
    for sample in (whole, first_half(whole)):
        response = diffuse_response(
            LightParts.of(light, filled), incoming(cosine_weights(sample.normals))
        )
        of = sample.normals[sample.voxel_of]
        mirrored = reflection(filled, ROUGHNESS, of, sample.directions)
        (found,) = infer_light_by_gloss(sample, response, mirrored, gloss_of(0.0), np.full(3, 0.3))
        sky = mean_radiance(
            completed_light(light, filled, found.unseen, found.excess), normals[-1:]
        )[0, 0]
        above.append(float(found.albedo[0] * sky))
    bound, without = above
    assert bound > 0.7
    assert without < 0.5


def first_half(sample):
    """Only the lower side."""
    return dataclasses.replace(
        sample,
        voxel_of=sample.voxel_of[:OF_A_SIDE],
        slot=sample.slot[:OF_A_SIDE],
        directions=sample.directions[:OF_A_SIDE],
        colours=sample.colours[:OF_A_SIDE],
        clipped=sample.clipped[:OF_A_SIDE],
    )


def test_a_channel_that_is_all_clipped_says_nothing():
    sample = ball(sky(), ALBEDO, 0.3, ROUGHNESS)
    light = seen_below(sky(), 0.3)
    filled = complete(light)
    sample.clipped[:, 0] = True
    (found,) = infer_light_by_gloss(
        sample,
        diffuse_response(LightParts.of(light, filled), incoming(cosine_weights(sample.normals))),
        reflection(filled, ROUGHNESS, sample.normals[sample.voxel_of], sample.directions),
        gloss_of(0.3),
        np.full(3, 0.3, np.float32),
    )
    assert found.albedo[0] == np.float32(0.3)
    assert found.deviation[0] == 1.0
    assert np.isfinite(found.unseen).all()
