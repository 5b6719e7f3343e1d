# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Whether an estimate's standard deviations and statuses predict its error."""

from __future__ import annotations

from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.evaluation.estimates import SceneEstimates
from reflest_core.evaluation.statistics.bootstrap import share_over_groups
from reflest_core.models.card import ParameterStatistics
from reflest_core.training.data.sample import Sample

LEVELS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
HEADLINE = 0.9
QUARTILES = 4


def measure_calibration(
    made: SceneEstimates, samples: list[Sample], statistics: ParameterStatistics
) -> dict[str, Any]:
    """Compare stated with actual errors of one split.

    Args:
        made: Estimates with standard deviations.
        samples: The scenes with their truth.
        statistics: Mean and standard deviation of the training set (Ward parameters).

    Returns:
        ``observed``: for each of :data:`LEVELS` the shares (5,) of truths inside the central normal
        interval of that probability. ``inside``: those of :data:`HEADLINE`, with intervals over
        environments. ``z_stddev``, ``z_mean``: of (estimate - truth) / stddev, ideally 1 and 0.
        ``quartiles`` by stated error, and errors by ``statuses``.
    """
    truths = np.stack([sample.ward for sample in samples])
    z = (made.ward - truths) / made.stddev
    squared = ((made.ward - truths) / statistics.stddev) ** 2
    inside = np.abs(z) <= half_width(HEADLINE)
    environments = [sample.environment for sample in samples]
    return {
        "scenes": len(samples),
        "levels": list(LEVELS),
        "observed": [(np.abs(z) <= half_width(level)).mean(axis=0).tolist() for level in LEVELS],
        "inside": inside.mean(axis=0).tolist(),
        "inside_intervals": [share_over_groups(inside[:, k], environments) for k in range(5)],
        "z_stddev": z.std(axis=0).tolist(),
        "z_mean": z.mean(axis=0).tolist(),
        "quartiles": _quartiles(squared, made.stddev / statistics.stddev),
        "statuses": _by_status(squared, made.statuses),
    }


def half_width(level: float) -> float:
    """Half the width of the central normal interval.

    Args:
        level: Its probability, in (0, 1).

    Returns:
        In standard deviations.
    """
    return NormalDist().inv_cdf(0.5 + 0.5 * level)


def _quartiles(
    squared: NDArray[np.float64], deviations: NDArray[np.float64]
) -> list[dict[str, float]]:
    """Scenes in four equal groups by the error that they say they have, both z-scored."""
    expected = (deviations**2).mean(axis=1)
    groups = np.array_split(np.argsort(expected, kind="stable"), QUARTILES)
    return [
        {
            "scenes": len(group),
            "expected": float(np.sqrt(expected[group].mean())),
            "rmse": float(np.sqrt(squared[group].mean())),
        }
        for group in groups
        if len(group)
    ]


def _by_status(squared: NDArray[np.float64], statuses: list[str]) -> list[dict[str, Any]]:
    """How often each status is raised and how wrong such estimates are; then all but OK."""
    found = np.array(statuses)
    groups = {status.name: found == status.name for status in EstimateStatus}
    groups["any but OK"] = found != EstimateStatus.OK.name
    return [
        {
            "status": name,
            "scenes": int(chosen.sum()),
            "share": float(chosen.mean()),
            "rmse": float(np.sqrt(squared[chosen].mean())) if chosen.any() else None,
            "per_parameter": np.sqrt(squared[chosen].mean(axis=0)).tolist()
            if chosen.any()
            else None,
        }
        for name, chosen in groups.items()
    ]
