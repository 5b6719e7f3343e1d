# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The posterior of roughness as numbers of order 1, for lightnet's update of its answer."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss.posterior import ALPHAS, GlossPosterior

GLOSS_EVIDENCE = len(ALPHAS) + 7
"""How many numbers there are."""
LEAST = 0.01
"""Added before the logarithm of a ``rho_s``."""
FURTHEST = -50.0
"""Log-likelihood below which values are not distinguished."""


def gloss_evidence(posterior: GlossPosterior | None) -> NDArray[np.float32]:
    """Describe what the observations say about roughness.

    Args:
        posterior: Of the same surface; None where there is none.

    Returns:
        (:data:`GLOSS_EVIDENCE`,) float32, the root of the log-likelihood below its maximum by
        roughness; then ``ln alpha``, its deviation, the logarithm of ``rho_s``, the gain over
        ``rho_s = 0``, the effective voxels, whether ``alpha`` is identifiable, and 1. All are 0
        where there is no posterior.
    """
    if posterior is None:
        return np.zeros(GLOSS_EVIDENCE, np.float32)
    below = np.maximum(posterior.log_likelihood, FURTHEST)
    scalars = [
        np.log(posterior.alpha) + 2.5,
        posterior.log_alpha_stddev,
        0.5 * np.log(max(posterior.rho_s_at_alpha, 0.0) + LEAST) + 1.0,
        np.arcsinh(posterior.delta_log_likelihood) / 5.0,
        np.log1p(posterior.effective_voxels) / 5.0,
        float(posterior.is_identifiable),
        1.0,
    ]
    return np.concatenate([-np.sqrt(-below / 10.0), scalars]).astype(np.float32)


def gloss_answers(posterior: GlossPosterior | None) -> NDArray[np.float32]:
    """Return (2,) float32 ``rho_s`` and ``alpha`` by the posterior; 0 where there is none.

    Args:
        posterior: Of the same surface; None where there is none.
    """
    if posterior is None:
        return np.zeros(2, np.float32)
    return np.array([posterior.rho_s_at_alpha, posterior.alpha], np.float32)
