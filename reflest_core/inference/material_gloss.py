# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Gloss of one of several materials, which are small and seldom show a highlight of seen light.

Each cue of gloss is weak alone: the network's answer, ``rho_s`` in the joint light, and how much
and how sharply colours change with the view (:mod:`.gloss.view_changes`). Linear regressions of
``alpha`` and of ``ln rho_s`` on them give the expected value over measured materials, which is the
prior that the likelihood of the highlights is then joined with.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss.view_changes import ViewChanges

ROUGHNESS = (0.2578, -0.145, -0.0857, -0.0263, 0.0486)
"""Intercept and coefficients of ``alpha``: on blur, peakedness, change over noise, and ``ln`` of
the network's ``alpha``. Fitted to 178 materials of 17 synthetic scans by
``scripts/fit_material_gloss.py``: left out, they err by 0.085, where a constant errs by 0.096."""
STRENGTH = (-0.0331, 0.4459, 0.2848, 0.1444)
"""Intercept and coefficients of ``ln(rho_s + LEAST)``: on the same of the joint light's and the
network's ``rho_s``, and on ``ln`` of the change between far views over the irradiance."""
BLUR, PEAKEDNESS, OVER_NOISE = (-1.01, 0.3), (-0.06, 1.44), (-0.74, 3.07)
CHANGE = (-5.83, -1.7)
NETWORK_ROUGHNESS = (-3.22, -1.42)
"""Ranges of the cues in those scans; beyond them they are held."""
LEAST = 0.005
"""Added to ``rho_s`` before its logarithm."""
ALPHAS = (0.015, 0.33)
"""Least and greatest ``alpha`` of a regression."""
ALPHA_ERROR, USUAL_ALPHA = 0.6, 0.12
"""Standard deviation of ``alpha`` over ``sqrt(alpha USUAL_ALPHA)``: 90 % intervals hold 90 %."""
LOG_STRENGTH_ERROR = 0.5
"""Standard deviation of ``ln(rho_s + LEAST)``."""


@dataclass(frozen=True)
class MaterialGloss:
    """Gloss as the cues together say, with standard deviations.

    Attributes:
        rho_s: specular albedo, the expected value.
        alpha: roughness, the expected value.
        rho_s_stddev: standard deviation of ``rho_s``.
        alpha_stddev: standard deviation of ``alpha``.
    """

    rho_s: float
    alpha: float
    rho_s_stddev: float
    alpha_stddev: float


def material_gloss(
    changes: ViewChanges,
    network: NDArray[np.float64],
    joint_rho_s: float,
    irradiance: float,
) -> MaterialGloss:
    """Regress gloss on all of its cues.

    Args:
        changes: of the material's colours with the view.
        network: (5,) the network's ``rho_d`` (3), ``rho_s``, ``alpha``.
        joint_rho_s: by the joint light.
        irradiance: mean ``E / pi`` on the material, linear.
    """
    cues = (
        _held(changes.blur, BLUR),
        _held(changes.peakedness, PEAKEDNESS),
        _held(changes.over_noise, OVER_NOISE),
        _held(math.log(max(float(network[4]), 1e-3)), NETWORK_ROUGHNESS),
    )
    expected = ROUGHNESS[0] + sum(a * b for a, b in zip(ROUGHNESS[1:], cues, strict=True))
    alpha = _held(expected, ALPHAS)
    change = math.log(changes.far_change / max(irradiance, 1e-6))
    of_strength = (_log_strength(joint_rho_s), _log_strength(network[3]), _held(change, CHANGE))
    log_strength = STRENGTH[0] + sum(a * b for a, b in zip(STRENGTH[1:], of_strength, strict=True))
    mean = math.exp(log_strength + 0.5 * LOG_STRENGTH_ERROR**2)
    return MaterialGloss(
        rho_s=min(max(mean - LEAST, 0.0), 1.0),
        alpha=alpha,
        rho_s_stddev=LOG_STRENGTH_ERROR * min(mean, 1.0),
        alpha_stddev=ALPHA_ERROR * math.sqrt(alpha * USUAL_ALPHA),
    )


def _log_strength(rho_s: float) -> float:
    return math.log(min(max(float(rho_s), 0.0), 1.0) + LEAST)


def _held(value: float, bounds: tuple[float, float]) -> float:
    return min(max(value, bounds[0]), bounds[1])
