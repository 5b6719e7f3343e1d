# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Lines with a known slope and intercept are found, and nothing is claimed without evidence."""

import numpy as np
import pytest

from reflest_core.models.lightnet.lobe_fit import fit_lobes

RHO_D, RHO_S, TRUE = np.array([0.5, 0.2, 0.1]), 0.3, 2


@pytest.fixture
def scene():
    rng = np.random.default_rng(0)
    lobe = rng.gamma(0.7, 1.0, (20, 12, 4, 3)).astype(np.float32)
    apparent = (RHO_D + RHO_S * lobe[:, :, TRUE]).astype(np.float32)
    return apparent, lobe, np.ones_like(apparent), np.ones(20, np.float32)


def test_the_true_roughness_explains_everything(scene):
    fit = fit_lobes(*scene)
    np.testing.assert_allclose(fit.scene[:, TRUE, 0], RHO_S, rtol=1e-3)
    np.testing.assert_allclose(fit.scene[:, TRUE, 1], RHO_D, atol=1e-3)
    np.testing.assert_allclose(fit.scene[:, TRUE, 2], 1.0, atol=5e-3)
    others = np.delete(fit.scene[..., 2], TRUE, axis=1)
    assert others.max() < 0.2
    np.testing.assert_allclose(fit.voxels[:, :, TRUE, 0], RHO_S, rtol=0.05)


def test_what_weighs_nothing_changes_nothing(scene):
    apparent, lobe, weight, voxels = scene
    expected = fit_lobes(apparent[:, :8], lobe[:, :8], weight[:, :8], voxels)
    weight[:, 8:], apparent[:, 8:] = 0.0, 99.0
    fit = fit_lobes(apparent, lobe, weight, voxels)
    np.testing.assert_allclose(fit.scene, expected.scene, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(fit.voxels, expected.voxels, rtol=1e-5, atol=1e-6)


def test_a_voxels_own_brightness_is_no_evidence_of_gloss(scene):
    """Only what varies within a voxel counts for the slope of the scene."""
    apparent, lobe, weight, voxels = scene
    offset = np.linspace(0.0, 5.0, 20)[:, None, None]
    fit = fit_lobes(apparent + offset, lobe, weight, voxels)
    np.testing.assert_allclose(fit.scene[:, TRUE, 0], RHO_S, rtol=1e-3)


def test_nothing_seen_is_slope_nought_and_no_error(scene):
    apparent, lobe, weight, voxels = scene
    fit = fit_lobes(apparent, lobe, 0.0 * weight, voxels)
    assert np.isfinite(fit.voxels).all()
    assert (fit.scene[..., 0] == 0.0).all()
    assert (fit.scene[..., 2] == 0.0).all()
