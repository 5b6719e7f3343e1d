# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a ``lightnet`` says of looks, beside the truth: errors, and whether its intervals hold."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.models.calibration import Calibration
from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.models.predictor import LARGEST_LOG_VARIANCE
from reflest_core.training.light.light_batches import whole_looks
from reflest_core.training.light.shadings import Shadings
from reflest_core.training.metrics import normalised_rmse

AT_ONCE = 64
HELD_SHARE = 0.9
HALF_WIDTH = NormalDist().inv_cdf(0.5 + HELD_SHARE / 2)
"""Of the interval that holds so much of a normal distribution, in standard deviations."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MeasuredLooks:
    """Ward parameters (L, 5) as ``estimates``, with ``deviations``, and as ``truths``.

    ``views``: (L,), how many each look has. ``environments``: (L,) names of their lights.
    ``statistics``: the training set's.
    """

    estimates: Array
    deviations: Array
    truths: Array
    views: NDArray[np.int64]
    environments: NDArray[np.str_]
    statistics: ParameterStatistics

    @staticmethod
    def of(
        module: torch.nn.Module,
        looks: Shadings,
        statistics: ParameterStatistics,
        without: tuple[str, ...],
        device: torch.device,
    ) -> MeasuredLooks:
        """Estimate from every look, in float32."""
        means, log_variances = [], []
        for start in range(0, len(looks), AT_ONCE):
            rows = np.arange(start, min(start + AT_ONCE, len(looks)))
            look = {n: tensor.to(device) for n, tensor in whole_looks(looks, rows, without).items()}
            with torch.inference_mode():
                mean, log_variance = module(**look)
            means.append(mean.double().cpu().numpy())
            log_variances.append(log_variance.double().cpu().numpy())
        logs = np.minimum(np.concatenate(log_variances), LARGEST_LOG_VARIANCE)
        return MeasuredLooks(
            statistics.restore(np.concatenate(means)),
            np.exp(0.5 * logs) * statistics.stddev,
            looks.ward.astype(np.float64),
            looks.views,
            looks.environment,
            statistics,
        )

    def of_views(self, views: int) -> MeasuredLooks:
        """Only the looks with so many views."""
        some = self.views == views
        return MeasuredLooks(
            self.estimates[some], self.deviations[some], self.truths[some], self.views[some],
            self.environments[some], self.statistics,
        )  # fmt: skip

    @property
    def view_counts(self) -> list[int]:
        """The numbers of views, most first."""
        return sorted({int(count) for count in self.views}, reverse=True)

    @property
    def criterion(self) -> float:
        """The mean, over numbers of views, of the normalised RMSE.

        So looks with many views, whose errors are small, say as much as those with few: squares of
        all together would hear the few above all.
        """
        rmses = [
            normalised_rmse(some.estimates, some.truths, self.statistics).overall
            for some in map(self.of_views, self.view_counts)
        ]
        return float(np.mean(rmses))

    def figures(self, calibration: Calibration) -> dict[str, Any]:
        """JSON values for each number of views; intervals as ``calibration`` makes them."""
        return {
            str(count): self.of_views(count)._figures(calibration) for count in self.view_counts
        }

    def _figures(self, calibration: Calibration) -> dict[str, Any]:
        rmse = normalised_rmse(self.estimates, self.truths, self.statistics)
        usual = self.statistics.stddev
        deviations = calibration.calibrated(self.deviations / usual) * usual
        held = np.abs(self.estimates - self.truths) <= HALF_WIDTH * deviations
        return {
            "looks": len(self.truths),
            "rmse": rmse.overall,
            "rmse_per_parameter": rmse.per_parameter.tolist(),
            "mean_rmse_of_parameters": float(rmse.per_parameter.mean()),
            "scene_median": rmse.scene_median,
            "scene_p95": rmse.scene_p95,
            "held_by_90_percent_intervals": held.mean(axis=0).tolist(),
        }
