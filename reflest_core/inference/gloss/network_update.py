# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A network's roughness joined with the posterior of the observations."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import ALPHA
from reflest_core.inference.gloss.posterior import GlossPosterior

LEAST_SPREAD, MOST_SPREAD = 0.45, 0.7
"""Least and greatest standard deviation of ``ln alpha`` that the network's answer is taken to have:
the greatest is what it has on measured materials."""
SURE = 1.0 / 3.0
"""Standard deviation over ``alpha``, up to which a network's answer stands without highlights."""
SMALLEST = 0.01
"""Roughness that the network's answer is taken to be at least."""


def with_posterior(
    ward: NDArray[np.float64], stddev: NDArray[np.float64], posterior: GlossPosterior
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return Ward parameters with the roughness that network and posterior give together.

    Both are Gaussians of ``ln alpha``. Where the posterior is not identifiable nothing changes.

    Args:
        ward: (5,) ``rho_d`` (3), ``rho_s``, ``alpha`` of the network.
        stddev: (5,) standard deviations of these.
        posterior: Of the same surface.

    Returns:
        ``ward`` and ``stddev`` as above.
    """
    if not posterior.is_identifiable:
        return ward, stddev
    expected = math.log(max(float(ward[ALPHA]), SMALLEST))
    spread = float(stddev[ALPHA]) / max(float(ward[ALPHA]), SMALLEST)
    precision = min(max(spread, LEAST_SPREAD), MOST_SPREAD) ** -2
    own = posterior.log_alpha_stddev**-2
    log_alpha = (own * math.log(posterior.alpha) + precision * expected) / (own + precision)
    spread = (own + precision) ** -0.5
    ward, stddev = ward.copy(), stddev.copy()
    ward[ALPHA] = math.exp(log_alpha)
    stddev[ALPHA] = ward[ALPHA] * spread
    return ward, stddev


def roughness_problem(
    ward: NDArray[np.float64], stddev: NDArray[np.float64] | None, posterior: GlossPosterior
) -> str:
    """Return why a roughness is uncertain, as a clause; "" where it is not.

    Args:
        ward: (5,) ``rho_d`` (3), ``rho_s``, ``alpha`` of the network, or with the posterior.
        stddev: (5,) standard deviations of these; None where they are unknown.
        posterior: Of the same surface.

    Returns:
        The posterior's reason, unless the network is sure of its answer.
    """
    is_sure = stddev is not None and float(stddev[ALPHA]) <= SURE * float(ward[ALPHA])
    return "" if is_sure else posterior.reason
