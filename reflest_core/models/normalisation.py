# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""z-scores: the training set's mean and standard deviation of each parameter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import PARAMETERS

WARD_NAMES = PARAMETERS
LABCD_NAMES = ("L", "a", "b", "c", "d")


@dataclass(frozen=True)
class ParameterStatistics:
    """``mean`` and ``stddev`` (5,) float64 over the training scenes, in the order of the names."""

    mean: NDArray[np.float64]
    stddev: NDArray[np.float64]

    @staticmethod
    def of(parameters: NDArray[np.float64]) -> ParameterStatistics:
        """Statistics of (S, 5) parameters."""
        return ParameterStatistics(parameters.mean(axis=0), parameters.std(axis=0))

    def normalise(self, parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        """Parameters (..., 5) to z-scores."""
        scores: NDArray[np.float64] = (parameters - self.mean) / self.stddev
        return scores

    def restore(self, scores: NDArray[np.float64]) -> NDArray[np.float64]:
        """z-scores (..., 5) to parameters."""
        parameters: NDArray[np.float64] = scores * self.stddev + self.mean
        return parameters
