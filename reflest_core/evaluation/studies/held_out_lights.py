# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""lightnet under environments of the training set, each measured by a training without it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.statistics.bootstrap import mean_of_roots_over_groups, over_groups
from reflest_core.training.light.calibration import fitted_calibration
from reflest_core.training.light.measured_scans import HALF_WIDTH, MeasuredScans
from reflest_core.training.metrics import NormalisedRmse

QUARTERS = 4


def measure_held_out_lights(folders: Sequence[Path]) -> dict[str, Any]:
    """Errors of several trainings on their held-out environments, and coverage of intervals.

    The intervals of each training are calibrated on the others, so that no environment has a part
    in its own calibration.

    Args:
        folders: Trainings of lightnet with ``--hold-out``.

    Raises:
        EvaluationError: there are fewer than two, or an environment was held out twice.
    """
    measured = [MeasuredScans.read(folder) for folder in folders]
    if len(measured) < 2:
        raise EvaluationError(
            "--held-out needs two trainings or more: intervals of one are calibrated on the others"
        )
    together = MeasuredScans.joined(measured)
    if len(together.lights) < sum(len(one.lights) for one in measured):
        raise EvaluationError("--held-out: each environment must be held out by one training alone")
    held = np.concatenate(_held(measured))
    return {
        "trainings": len(measured),
        "lights": len(together.lights),
        "views": {
            str(count): _figures(together, held, together.views == count)
            for count in together.view_counts
        },
    }


def _held(measured: list[MeasuredScans]) -> list[NDArray[np.bool_]]:
    """For each training which truths (L, 5) its 90 % intervals hold."""
    found = []
    for k, one in enumerate(measured):
        others = MeasuredScans.joined(measured[:k] + measured[k + 1 :])
        calibration = fitted_calibration(others)
        found.append(np.abs(one.errors) <= HALF_WIDTH * calibration.calibrated(one.deviations))
    return found


def _figures(
    together: MeasuredScans, held: NDArray[np.bool_], chosen: NDArray[np.bool_]
) -> dict[str, Any]:
    some = together.where(chosen)
    rmse = NormalisedRmse.of(some.errors)
    squared, lights = some.errors**2, some.environments.tolist()
    return {
        "variants": len(some.errors),
        "rmse": rmse.overall,
        "per_parameter": rmse.per_parameter.tolist(),
        "mean_of_parameters": float(rmse.per_parameter.mean()),
        "scene_mean": rmse.scene_mean,
        "over_environments": asdict(over_groups(squared.mean(axis=1), lights)),
        "mean_over_environments": asdict(mean_of_roots_over_groups(squared, lights)),
        "inside": held[chosen].mean(axis=0).tolist(),
        "inside_by_quarter": [
            [
                float(held[chosen][quarter, k].mean())
                for quarter in np.array_split(np.argsort(some.deviations[:, k]), QUARTERS)
            ]
            for k in range(5)
        ],
        "by_light": some.rmse_by_light(),
    }
