# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Whether observations hold enough information on roughness, and how closely they determine it.

Neighbouring observations err together, so the likelihood of independent errors is too sharp. Parts
of the surface measure how much too sharp: the variance of their likelihoods' slopes at the maximum
should equal the curvature there. The likelihood is raised to the power that makes it so (Pauli,
Racugno and Ventura 2011, "Bayesian composite marginal likelihoods").
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LEAST_GAIN = 40.0
"""Log-likelihood over ``rho_s = 0``, below which roughness cannot be determined."""
FEWEST_VOXELS = 60.0
"""Effective voxels, below which it cannot."""
MOST_CLIPPED = 0.5
"""Share of clipped observations, above which it cannot: they say hardly more than 'bright'."""
MOST_SPREAD = 0.5
"""Standard deviation of ``ln alpha`` by the parts' disagreement, above which it cannot."""
MODEL_ERROR = 0.3
"""Standard deviation of ``ln alpha`` that no number of observations removes: what the light's map,
the model of the normals' errors and the camera's processing contribute."""
EDGE_ERROR = 0.5
"""The same where the likelihood is greatest at the least or the greatest roughness."""
FINE = 200
"""Roughnesses at which the likelihood is interpolated."""
MOST_POWER = 0.5
"""Of the likelihood: never are all errors independent."""


@dataclass(frozen=True)
class Identifiability:
    """What the likelihoods of a surface and of its parts say about roughness.

    Attributes:
        probability: (K,) posterior under a flat prior of ``ln alpha``; sums to 1.
        log_alpha: Posterior mean of ``ln alpha``.
        log_alpha_stddev: Standard deviation of ``ln alpha``, with the model's own error.
        gain: Log-likelihood over ``rho_s = 0``.
        reason: Why roughness cannot be determined, as a clause; "" where it can.
    """

    probability: NDArray[np.float64]
    log_alpha: float
    log_alpha_stddev: float
    gain: float
    reason: str


def identifiability(
    alphas: NDArray[np.float64],
    of_parts: NDArray[np.float64],
    log_prior: NDArray[np.float64],
    matte: float,
    effective_voxels: float,
    clipped_share: float = 0.0,
    least_gain: float = LEAST_GAIN,
    fewest_voxels: float = FEWEST_VOXELS,
) -> Identifiability:
    """Judge the likelihood of K roughnesses.

    Args:
        alphas: (K,) at least three, evenly spaced in their logarithms.
        of_parts: (P, K) log-likelihood of the observations of each spatial part.
        log_prior: (K,) of what else was fitted at each roughness.
        matte: Log-likelihood of all observations at ``rho_s = 0``.
        effective_voxels: Sum of the voxels' trust.
        clipped_share: Of the observations, those that are bounds alone.
        least_gain: Log-likelihood over ``rho_s = 0`` that is asked for.
        fewest_voxels: Effective voxels that are asked for.

    Returns:
        Posterior, deviation and reason.
    """
    logs = np.log(alphas)
    total = of_parts.sum(axis=0) + log_prior
    peak = int(total.argmax())
    power = _power(total, of_parts, peak)
    fine = np.linspace(logs[0], logs[-1], FINE)
    between = power * _interpolated(logs, total - total[peak], fine)
    weights = np.exp(between - between.max())
    weights /= weights.sum()
    mean = float(weights @ fine)
    spread = math.sqrt(float(weights @ (fine - mean) ** 2))
    probability = np.exp(power * (total - total[peak]))
    probability /= probability.sum()
    gain = float(total[peak]) - matte
    reason = ""
    if effective_voxels < fewest_voxels:
        reason = (
            f"{effective_voxels:.0f} voxels of good normals mirror light that was seen, "
            f"{fewest_voxels:.0f} are needed"
        )
    elif clipped_share > MOST_CLIPPED:
        reason = f"{clipped_share:.0%} of the highlights are overexposed"
    elif gain < least_gain:
        reason = (
            f"highlights raise the log-likelihood by {max(gain, 0.0):.0f}, "
            f"{least_gain:.0f} are needed"
        )
    elif spread > MOST_SPREAD:
        reason = f"parts of the surface disagree by {math.expm1(spread):.0%}"
    error = EDGE_ERROR if peak in (0, len(alphas) - 1) else MODEL_ERROR
    return Identifiability(probability, mean, math.hypot(spread, error), gain, reason)


def _interpolated(
    logs: NDArray[np.float64], values: NDArray[np.float64], fine: NDArray[np.float64]
) -> NDArray[np.float64]:
    """``values`` at ``fine``: a parabola in ``alpha`` about the maximum, lines elsewhere."""
    middle = min(max(int(values.argmax()), 1), len(logs) - 2)
    around = slice(middle - 1, middle + 2)
    centre = np.exp(logs[middle])
    curve = np.polyfit(np.exp(logs[around]) / centre, values[around], 2)
    parabola = np.polyval(curve, np.exp(fine) / centre)
    is_near = np.abs(fine - logs[middle]) <= logs[1] - logs[0]
    return np.where(is_near, parabola, np.interp(fine, logs, values))


def _power(total: NDArray[np.float64], of_parts: NDArray[np.float64], peak: int) -> float:
    """The power of the likelihood that its parts' disagreement asks for.

    A log-likelihood ratio of independent errors has a variance of twice its mean. Here both are
    measured between the maximum and the roughnesses beside it.
    """
    beside = [k for k in (peak - 1, peak + 1) if 0 <= k < len(total)]
    ratios = of_parts[:, [peak]] - of_parts[:, beside]
    parts = len(of_parts)
    variance = float(ratios.var(axis=0).sum()) * parts * parts / (parts - 1)
    return min(2.0 * float(ratios.sum()) / max(variance, 1e-9), MOST_POWER)
