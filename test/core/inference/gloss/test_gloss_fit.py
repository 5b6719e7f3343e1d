# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Gloss and roughness from changes with the view, whatever the diffuse light."""

import numpy as np
import pytest

from reflest_core.inference.gloss.gloss_fit import EVIDENCE, GlossFit, fit_gloss
from reflest_core.inference.gloss.gloss_kernel import _first_deviation

K, TRUE, GLOSS = 8, 2, 0.35


@pytest.fixture
def scene():
    """40 voxels, 10 views each, under diffuse light of any strength; all light was seen."""
    rng = np.random.default_rng(0)
    voxel_of = np.repeat(np.arange(40), 10)
    lobes = np.ones((400, K, 5), np.float32)
    lobes[..., :3] = rng.gamma(1.0, 0.3, (400, K, 3))
    lobes[..., 4] = 0.0
    diffuse = rng.uniform(0.02, 0.4, (40, 3))
    colours = diffuse[voxel_of] + GLOSS * lobes[:, TRUE, :3]
    return colours.astype(np.float32), np.zeros((400, 3), np.bool_), lobes, voxel_of


def test_gloss_and_roughness_are_found_whatever_the_diffuse_light(scene):
    fit = fit_gloss(*scene)
    assert fit.gloss[TRUE] == pytest.approx(GLOSS, abs=0.01)
    assert fit.weight.argmax() == TRUE
    assert fit.weight[TRUE] > 0.9
    assert fit.misfit.argmin() == TRUE


def test_outliers_hardly_matter(scene):
    colours, clipped, lobes, voxel_of = scene
    colours = colours.copy()
    colours[::15] += 2.0
    fit = fit_gloss(colours, clipped, lobes, voxel_of)
    assert fit.gloss[TRUE] == pytest.approx(GLOSS, abs=0.05)


def test_lobes_into_unseen_light_are_left_out(scene):
    """Their radiance is a guess: here it is far off, and must not be believed."""
    colours, clipped, lobes, voxel_of = scene
    lobes = lobes.copy()
    lobes[::3, :, :3] *= 20.0
    lobes[::3, :, 3] = 0.0
    fit = fit_gloss(colours, clipped, lobes, voxel_of)
    assert fit.gloss[TRUE] == pytest.approx(GLOSS, abs=0.01)
    assert (fit_gloss(*scene).deviation < fit.deviation).all()


@pytest.mark.parametrize("is_lamp", [True, False])
def test_what_is_beyond_white_or_beyond_the_fill_is_separated_from_the_gloss(scene, is_lamp):
    """Some lobes see a clipped lamp, or a sky that the fill took for too dark, in part."""
    colours, clipped, lobes, voxel_of = scene
    lobes = lobes.copy()
    share = np.zeros(len(colours), np.float32)
    share[::3] = np.random.default_rng(1).uniform(0.1, 0.4, len(share[::3]))
    if is_lamp:
        lobes[..., 4] = share[:, None]
    else:
        lobes[..., 3] = 1.0 - share[:, None]
    brighter = colours + np.float32(GLOSS * 2.0) * share[:, None]
    fit = fit_gloss(brighter, clipped, lobes, voxel_of)
    assert fit.gloss[TRUE] == pytest.approx(GLOSS, abs=0.01)
    assert fit.weight.argmax() == TRUE
    unaware = np.where([False, False, False, True, False], 1.0, lobes) * [1, 1, 1, 1, 0]
    misled = fit_gloss(brighter, clipped, unaware.astype(np.float32), voxel_of)
    assert fit.misfit[TRUE] < 0.5 * misled.misfit[TRUE]


@pytest.mark.parametrize("count", [0.0, 50.0, 400.0])
def test_the_more_observations_count_the_surer_is_the_roughness(count):
    misfit = np.full(K, 1.05, np.float32)
    misfit[TRUE] = 1.0
    nothing = np.zeros(K, np.float32)
    fit = GlossFit(nothing, nothing, misfit, nothing + np.float32(count))
    odds = fit.weight[TRUE] / fit.weight[0]
    assert odds == pytest.approx(1.05 ** (EVIDENCE * count), rel=1e-3)
    assert fit.weight_by(1.0)[TRUE] >= fit.weight[TRUE]


def test_the_deviation_is_that_of_the_first_of_three_unknowns():
    matrix = np.array([[4.0, 1.0, 0.5], [1.0, 3.0, 0.7], [0.5, 0.7, 2.0]])
    expected = np.sqrt(np.linalg.inv(matrix)[0, 0])
    assert _first_deviation(matrix) == pytest.approx(expected)


def test_clipped_observations_are_left_out(scene):
    colours, clipped, lobes, voxel_of = scene
    bright = colours > 0.5
    fit = fit_gloss(np.minimum(colours, 0.5), clipped | bright, lobes, voxel_of)
    assert fit.gloss[TRUE] == pytest.approx(GLOSS, abs=0.02)


def test_clipped_observations_are_lower_bounds(scene):
    """All observations of the gloss are clipped: it is at least what makes the model as bright."""
    colours, clipped, lobes, voxel_of = scene
    colours, clipped, lobes = colours.copy(), clipped.copy(), lobes.copy()
    lobes[..., :3], colours[:] = 0.1, 0.2
    lobes[::10, :, :3], colours[::10], clipped[::10] = 3.0, 1.0, True
    fit = fit_gloss(colours, clipped, lobes, voxel_of)
    assert fit.gloss[TRUE] == pytest.approx(0.8 / 2.9, abs=0.03)
    unbound = np.ones(len(colours), np.bool_)
    unbound[::10] = False
    without = fit_gloss(colours[unbound], clipped[unbound], lobes[unbound], voxel_of[unbound])
    assert without.gloss[TRUE] < 0.05
    lobes[::10, :, :3] = 30.0
    assert fit_gloss(colours, clipped, lobes, voxel_of).gloss[TRUE] < 0.8 / 2.9 / 5


def test_a_lamp_where_none_is_mirrored_does_not_hide_the_gloss(scene):
    """At the resolution of the light, lobes beside a lamp far above white see it, or do not."""
    colours, clipped, lobes, voxel_of = scene
    lobes = lobes.copy()
    lobes[::40, :, :3] += 100.0
    fit = fit_gloss(colours, clipped, lobes, voxel_of)
    assert fit.gloss[TRUE] == pytest.approx(GLOSS, abs=0.03)
    assert fit.weight.argmax() == TRUE


def test_without_evidence_there_is_no_gloss_and_no_error(scene):
    colours, clipped, lobes, voxel_of = scene
    for nothing in (
        fit_gloss(colours, ~clipped, lobes, voxel_of),
        fit_gloss(colours[:0], clipped[:0], lobes[:0], voxel_of[:0]),
    ):
        assert (nothing.gloss == 0.0).all()
        assert all(np.isfinite(values).all() for values in vars(nothing).values())
        np.testing.assert_allclose(nothing.weight, 1.0 / K, rtol=1e-5)


def test_four_times_the_observations_tempered_by_four_are_as_sure_as_the_observations(scene):
    colours, clipped, lobes, voxel_of = scene
    rng = np.random.default_rng(2)
    colours = colours + rng.normal(0.0, 0.02, colours.shape).astype(np.float32)
    once = fit_gloss(colours, clipped, lobes, voxel_of)
    four_times = [np.concatenate([of] * 4) for of in (colours, clipped, lobes)]
    voxels = np.concatenate([voxel_of + 40 * copy for copy in range(4)])
    tempered = fit_gloss(*four_times, voxels).tempered(4.0)
    np.testing.assert_allclose(tempered.count, once.count, rtol=1e-3)
    np.testing.assert_allclose(tempered.deviation, once.deviation, rtol=0.02)
    np.testing.assert_allclose(tempered.weight, once.weight, atol=0.02)
