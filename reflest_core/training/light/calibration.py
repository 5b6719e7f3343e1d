# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Calibrates ``lightnet``'s standard deviations on scans under lights that it never saw."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from reflest_core.brdf.parameters import ALPHA, RHO_D, RHO_S
from reflest_core.models.card import Calibration
from reflest_core.training.light.measured_scans import HALF_WIDTH, HELD_SHARE, MeasuredScans

KINDS = (RHO_D, slice(RHO_S, RHO_S + 1), slice(ALPHA, ALPHA + 1))
"""Which parameters share a fit: the channels of ``rho_d``, which pass the same weights (which
of them errs more depends on the few lights that were held out); ``rho_s``; ``alpha``."""
POWERS = (0.3, 3.0)
"""The powers tried."""
SMALLEST = 1e-6
"""Smaller z-scored errors count as this one."""
FARTHEST = 3.0
"""Errors of more standard deviations than this count as this many in the correlation."""


def fitted_calibration(held_out: MeasuredScans) -> Calibration:
    """Fit a calibration by which 90 % intervals hold 90 % of the truths, at all deviations.

    The 0.9-quantile of the errors is fitted as a power law of the stated deviations, by quantile
    regression of their logarithms (Koenker and Bassett 1978), for each of :data:`KINDS`. Each light
    counts as much as any other, however many scans it has.

    Args:
        held_out: Errors under lights that training never saw.
    """
    factors, powers = np.ones(5), np.ones(5)
    for kind in KINDS:
        errors = np.abs(held_out.errors[:, kind])
        weights = np.repeat(held_out.light_weights(), errors.shape[1])
        factors[kind], powers[kind] = _power_law(
            np.log(np.maximum(errors, SMALLEST)).ravel(),
            np.log(held_out.deviations[:, kind]).ravel(),
            weights,
        )
    calibrated = Calibration(factors, powers).calibrated(held_out.deviations)
    return Calibration(factors, powers, _correlation(held_out.errors / calibrated))


def _power_law(
    log_errors: NDArray[np.float64],
    log_deviations: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> tuple[float, float]:
    """Factor and power of the deviation whose 90 % interval ends at the errors' quantile.

    The tilted absolute loss is convex in both; for each power the best factor is a quantile.
    """

    def offset(power: float) -> float:
        return _quantile(log_errors - power * log_deviations, weights)

    def loss(power: float) -> float:
        above = log_errors - power * log_deviations - offset(power)
        tilted = np.where(above > 0.0, HELD_SHARE * above, (HELD_SHARE - 1.0) * above)
        return float((weights * tilted).sum())

    if np.ptp(log_deviations) == 0.0:
        return float(np.exp(offset(1.0))) / HALF_WIDTH, 1.0
    power = float(minimize_scalar(loss, bounds=POWERS, method="bounded").x)
    return float(np.exp(offset(power))) / HALF_WIDTH, power


def _quantile(values: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    """The weighted quantile of :data:`HELD_SHARE`."""
    order = np.argsort(values)
    passed = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(passed, HELD_SHARE * passed[-1])])


def _correlation(scores: NDArray[np.float64]) -> NDArray[np.float64]:
    limited = np.clip(scores, -FARTHEST, FARTHEST)
    moments = limited.T @ limited
    deviations = np.sqrt(np.diag(moments))
    return np.asarray(moments / np.outer(deviations, deviations))
