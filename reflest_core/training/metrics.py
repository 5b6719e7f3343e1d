# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The headline figure: RMSE of z-scored parameters; 1.0 is guessing the mean (Tables 2 and 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.models.card import ParameterStatistics


@dataclass(frozen=True)
class NormalisedRmse:
    """Root mean square of z-scored errors.

    Attributes:
        overall: Over parameters and scenes.
        per_parameter: (5,), over scenes.
        scene_mean: Mean over scenes of the RMSE over a scene's parameters.
        scene_median: Median of the same.
        scene_p95: 95th percentile of the same.
    """

    overall: float
    per_parameter: NDArray[np.float64]
    scene_mean: float
    scene_median: float
    scene_p95: float

    @staticmethod
    def of(errors: NDArray[np.float64]) -> NormalisedRmse:
        """Compute it from (S, 5) errors of z-scored parameters.

        Args:
            errors: (S, 5) errors of z-scored parameters.
        """
        scenes = np.sqrt((errors**2).mean(axis=1))
        return NormalisedRmse(
            overall=float(np.sqrt((errors**2).mean())),
            per_parameter=np.sqrt((errors**2).mean(axis=0)),
            scene_mean=float(scenes.mean()),
            scene_median=float(np.median(scenes)),
            scene_p95=float(np.percentile(scenes, 95)),
        )


def normalised_rmse(
    estimates: NDArray[np.float64], truths: NDArray[np.float64], statistics: ParameterStatistics
) -> NormalisedRmse:
    """Compare estimates with truths.

    Args:
        estimates: (S, 5) parameters.
        truths: (S, 5) parameters.
        statistics: The *training* set's, for the z-scores.
    """
    return NormalisedRmse.of(statistics.normalise(estimates) - statistics.normalise(truths))
