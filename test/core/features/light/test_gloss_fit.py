# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Gloss and roughness from changes with the view, whatever the diffuse light."""

import numpy as np
import pytest

from reflest_core.features.light.gloss_fit import fit_gloss

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


def test_lobes_into_unseen_or_clipped_light_are_left_out(scene):
    """Their radiance is a guess: here it is far off, and must not be believed."""
    colours, clipped, lobes, voxel_of = scene
    lobes = lobes.copy()
    lobes[::3, :, :3] *= 20.0
    lobes[::6, :, 3] = 0.0
    lobes[3::6, :, 4] = 1.0
    fit = fit_gloss(colours, clipped, lobes, voxel_of)
    assert fit.gloss[TRUE] == pytest.approx(GLOSS, abs=0.02)
    assert (fit_gloss(*scene).deviation < fit.deviation).all()


def test_clipped_observations_are_left_out(scene):
    colours, clipped, lobes, voxel_of = scene
    bright = colours > 0.5
    fit = fit_gloss(np.minimum(colours, 0.5), clipped | bright, lobes, voxel_of)
    assert fit.gloss[TRUE] == pytest.approx(GLOSS, abs=0.02)


def test_without_evidence_there_is_no_gloss_and_no_error(scene):
    colours, clipped, lobes, voxel_of = scene
    for nothing in (fit_gloss(colours, ~clipped, lobes, voxel_of),
                    fit_gloss(colours[:0], clipped[:0], lobes[:0], voxel_of[:0])):  # fmt: skip
        assert (nothing.gloss == 0.0).all()
        assert all(np.isfinite(values).all() for values in vars(nothing).values())
        np.testing.assert_allclose(nothing.weight, 1.0 / K, rtol=1e-5)
