# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Making ``lightnet``'s standard deviations true, on looks under light that it never saw."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.models.weights import load_weights
from reflest_core.training.light.measured_looks import HALF_WIDTH, HELD_SHARE, MeasuredLooks
from reflest_core.training.sample import TrainingError

FARTHEST = 3.0
"""Errors of more standard deviations than this count as this many in the correlation."""


@dataclass(frozen=True)
class Calibration:
    """``factors`` (5,) of the standard deviations, ``correlation`` (5, 5) of errors over them."""

    factors: NDArray[np.float64] = field(default_factory=lambda: np.ones(5))
    correlation: NDArray[np.float64] = field(default_factory=lambda: np.eye(5))

    @staticmethod
    def of(measured: MeasuredLooks) -> Calibration:
        """Such that 90 % intervals hold 90 % of the measured truths, of each kind of parameter.

        So under the mean environment, for scenes of one err alike, and a scan stands in a new one:
        each counts as much as any other. The channels of ``rho_d`` pass the same weights and so
        share their factor: which of them erred more is what the few lights that were held out had,
        not the network.
        """
        scores = (measured.estimates - measured.truths) / measured.deviations
        lights = [scores[measured.environments == one] for one in np.unique(measured.environments)]
        factors = np.mean([_factors(of_light) for of_light in lights], axis=0)
        limited = np.clip(scores / factors, -FARTHEST, FARTHEST)
        moments = limited.T @ limited
        deviations = np.sqrt(np.diag(moments))
        return Calibration(factors, moments / np.outer(deviations, deviations))

    @staticmethod
    def read(path: Path) -> Calibration:
        """That of another run's weight file; :class:`TrainingError` where it has none."""
        _, card, _ = load_weights(path)
        if card.network != "lightnet" or not card.recipe.get("hold_out"):
            raise TrainingError(
                f"{path} was not calibrated; give --calibration the weights of a training of "
                "lightnet with --hold-out"
            )
        return Calibration(card.stddev_factors, card.error_correlation)


def _factors(scores: NDArray[np.float64]) -> NDArray[np.float64]:
    """(5,) by the ``scores`` (L, 5) of one light: errors in stated deviations."""
    factors = np.quantile(np.abs(scores), HELD_SHARE, axis=0) / HALF_WIDTH
    factors[:3] = np.quantile(np.abs(scores[:, :3]), HELD_SHARE) / HALF_WIDTH
    return np.asarray(factors)
