# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The posterior of roughness as numbers of order 1."""

import numpy as np

from reflest_core.inference.gloss.posterior import ALPHAS, GlossPosterior
from reflest_core.models.lightnet.gloss_evidence import (
    GLOSS_EVIDENCE,
    gloss_answers,
    gloss_evidence,
)

K = len(ALPHAS)


def posterior(peak=4, gain=200.0):
    log_likelihood = -30.0 * (np.arange(K) - peak) ** 2.0
    probability = np.exp(log_likelihood)
    return GlossPosterior(
        alphas=ALPHAS,
        log_likelihood=log_likelihood,
        rho_s=np.full(K, 0.04),
        rho_d=np.full((1, K, 3), 0.1),
        probability=probability / probability.sum(),
        alpha=float(ALPHAS[peak]),
        log_alpha_stddev=0.2,
        delta_log_likelihood=gain,
        effective_voxels=150.0,
        is_identifiable=True,
        reason="",
    )


def test_numbers_are_of_order_one_for_extreme_posteriors():
    for one in (posterior(), posterior(0, -1e6), posterior(K - 1, 1e9)):
        evidence = gloss_evidence(one)
        assert evidence.shape == (GLOSS_EVIDENCE,)
        assert evidence.dtype == np.float32
        assert np.abs(evidence).max() < 6.0


def test_the_peak_moves_with_the_roughness_and_answers_are_the_posteriors():
    for peak in (1, 6, 10):
        evidence = gloss_evidence(posterior(peak))
        assert evidence[:K].argmax() == peak
        np.testing.assert_allclose(gloss_answers(posterior(peak)), [0.04, ALPHAS[peak]], rtol=1e-6)


def test_no_posterior_is_all_zeros():
    assert not gloss_evidence(None).any()
    assert not gloss_answers(None).any()
