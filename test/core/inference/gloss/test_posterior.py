# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The posterior of roughness: right where observations hold information, honest where not."""

import dataclasses
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from reflest_core.inference.gloss.posterior import gloss_posterior
from reflest_core.light.completion import complete
from reflest_core.light.octahedral import octahedral_directions
from test.core.inference.gloss.lit_sphere import room, sphere

LIGHT = room()
PLASTIC = (0.2, 0.1, 0.05)


def posterior(surface, segments=None, light=LIGHT, **options):
    everything = [np.arange(surface.voxel_count)]
    return gloss_posterior(surface, complete(light), segments or everything, **options)


@pytest.mark.parametrize(
    ("rho_d", "rho_s", "alpha"),
    [
        (PLASTIC, 0.05, 0.05),
        (PLASTIC, 0.1, 0.15),
        ((0.03, 0.03, 0.04), 0.016, 0.02),
        ((0.6, 0.5, 0.5), 0.05, 0.08),
    ],
    ids=["plastic", "satin", "dark and crisp", "bright"],
)
def test_the_likelihood_is_greatest_at_the_true_roughness(rho_d, rho_s, alpha):
    found = posterior(sphere(LIGHT, rho_d, rho_s, alpha))
    assert found.is_identifiable, found.reason
    assert found.reason == ""
    assert abs(np.log(found.alpha / alpha)) < 1.5 * found.log_alpha_stddev
    assert found.alpha == pytest.approx(alpha, rel=0.2, abs=0.01)
    assert found.rho_s_at_alpha == pytest.approx(rho_s, rel=0.15)
    best = found.log_likelihood.argmax()
    np.testing.assert_allclose(found.rho_d[0, best], rho_d, rtol=0.1)


def test_a_matte_surface_holds_no_information_on_roughness():
    found = posterior(sphere(LIGHT, PLASTIC, 0.0, 0.1))
    assert not found.is_identifiable
    assert "log-likelihood" in found.reason
    assert found.delta_log_likelihood < 20.0


def test_light_that_was_not_seen_gives_no_information_on_roughness():
    unseen = dataclasses.replace(LIGHT, coverage=np.full_like(LIGHT.coverage, 1e-3))
    found = posterior(sphere(LIGHT, PLASTIC, 0.05, 0.05), light=unseen)
    assert not found.is_identifiable
    assert "are needed" in found.reason


def test_half_of_the_light_is_enough():
    coverage = (octahedral_directions(len(LIGHT.coverage))[..., 0] > 0.0).astype(np.float32)
    half = dataclasses.replace(
        LIGHT, coverage=coverage, radiance=LIGHT.radiance * coverage[..., None]
    )
    found = posterior(sphere(LIGHT, PLASTIC, 0.05, 0.05), light=half)
    assert found.is_identifiable, found.reason
    assert found.alpha == pytest.approx(0.05, rel=0.3)


def test_windows_that_the_camera_clipped_are_found_brighter_than_white():
    bright = room(brightest=4.0)
    clipped = (bright.radiance > 1.0).astype(np.float32)
    seen = dataclasses.replace(bright, radiance=np.minimum(bright.radiance, 1.0), clipped=clipped)
    found = posterior(sphere(bright, PLASTIC, 0.05, 0.05), light=seen)
    assert found.is_identifiable, found.reason
    assert found.alpha == pytest.approx(0.05, rel=0.3)
    assert found.rho_s_at_alpha == pytest.approx(0.05, rel=0.5)


def test_segments_share_gloss_and_have_albedos_of_their_own():
    is_top = np.arange(4000) < 2000
    rho_d = np.where(is_top[:, None], PLASTIC, (0.05, 0.3, 0.4))
    surface = sphere(LIGHT, rho_d, 0.05, 0.05)
    segments = [np.flatnonzero(is_top), np.flatnonzero(~is_top)]
    found = posterior(surface, segments)
    best = found.log_likelihood.argmax()
    assert found.alpha == pytest.approx(0.05, rel=0.2)
    np.testing.assert_allclose(found.rho_d[0, best], PLASTIC, rtol=0.1)
    np.testing.assert_allclose(found.rho_d[1, best], (0.05, 0.3, 0.4), rtol=0.1)
    swapped = posterior(surface, [np.flip(segment) for segment in reversed(segments)])
    assert swapped.alpha == found.alpha
    np.testing.assert_array_equal(swapped.rho_d, found.rho_d[::-1])


def test_the_order_of_voxels_does_not_matter():
    surface = sphere(LIGHT, PLASTIC, 0.05, 0.05)
    order = np.random.default_rng(1).permutation(surface.voxel_count)
    counts = surface.observation_counts[order]
    rows = np.concatenate([np.arange(*surface.offsets[v : v + 2]) for v in order])
    shuffled = dataclasses.replace(
        surface,
        positions=surface.positions[order],
        normals=surface.normals[order],
        offsets=np.concatenate([[0], np.cumsum(counts)]),
        colours=surface.colours[rows],
        view_indices=surface.view_indices[rows],
    )
    found, again = posterior(surface), posterior(shuffled)
    assert again.alpha == pytest.approx(found.alpha, rel=1e-3)
    assert again.delta_log_likelihood == pytest.approx(found.delta_log_likelihood, rel=1e-3)


def test_the_bits_do_not_depend_on_threads():
    surface = sphere(LIGHT, PLASTIC, 0.05, 0.05)
    alone = posterior(surface)
    with ThreadPoolExecutor(4) as pool:
        beside = list(pool.map(posterior, [surface] * 4))
    for found in beside:
        np.testing.assert_array_equal(found.log_likelihood, alone.log_likelihood)
        np.testing.assert_array_equal(found.rho_d, alone.rho_d)
        assert (found.alpha, found.log_alpha_stddev) == (alone.alpha, alone.log_alpha_stddev)


def test_fewer_voxels_leave_more_uncertainty():
    surface = sphere(LIGHT, PLASTIC, 0.05, 0.05, noise=0.02)
    many, few = (posterior(surface, most=most) for most in (300, 70))
    assert few.delta_log_likelihood < many.delta_log_likelihood
    assert few.effective_voxels < many.effective_voxels


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("voxels", [0, 1, 5])
def test_hardly_any_voxels_give_a_flat_posterior_and_the_reason(voxels):
    surface = sphere(LIGHT, PLASTIC, 0.05, 0.05)
    found = posterior(surface, [np.arange(voxels)])
    assert not found.is_identifiable
    assert "are needed" in found.reason
    assert np.isfinite([found.alpha, found.log_alpha_stddev]).all()
    np.testing.assert_allclose(found.probability.sum(), 1.0)
