# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Normalised RMSE of estimates of a split, with bootstrap intervals: one row of Table 2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.evaluation.statistics.bootstrap import (
    Interval,
    mean_of_roots_over_groups,
    over_groups,
    over_scenes,
)
from reflest_core.models.card import ParameterStatistics
from reflest_core.training.data.sample import Sample
from reflest_core.training.metrics import NormalisedRmse, normalised_rmse

Statistics = dict[str, ParameterStatistics]
"""The training set's, for ``ward`` and for ``labcd``."""


@dataclass(frozen=True)
class Accuracy:
    """The errors of S estimates.

    Attributes:
        scenes: S.
        environments: Number of different environments.
        ward: Normalised RMSE of ``rho_d``, ``rho_s``, ``alpha``.
        labcd: Normalised RMSE of ``L, a, b, c, d``.
        over_scenes: 95 % interval of ``ward.overall``, scenes resampled.
        over_environments: The same, environments resampled.
        mean_over_environments: 95 % interval of the mean of ``ward.per_parameter``.
    """

    scenes: int
    environments: int
    ward: NormalisedRmse
    labcd: NormalisedRmse
    over_scenes: Interval
    over_environments: Interval
    mean_over_environments: Interval


def accuracy(
    estimates: NDArray[np.float64], samples: list[Sample], statistics: Statistics
) -> Accuracy:
    """Measure estimates against the truth.

    Args:
        estimates: (S, 5) Ward parameters.
        samples: S scenes with their truth.
        statistics: Mean and standard deviation of the training set, for ``ward`` and ``labcd``.
    """
    environments = [sample.environment for sample in samples]
    truths = np.stack([sample.ward for sample in samples])
    squared = _squared_errors(estimates, truths, statistics)
    return Accuracy(
        scenes=len(samples),
        environments=len(set(environments)),
        ward=normalised_rmse(estimates, truths, statistics["ward"]),
        labcd=normalised_rmse(ward_to_labcd(estimates), ward_to_labcd(truths), statistics["labcd"]),
        over_scenes=over_scenes(squared.mean(axis=1)),
        over_environments=over_groups(squared.mean(axis=1), environments),
        mean_over_environments=mean_of_roots_over_groups(squared, environments),
    )


def scene_errors(
    estimates: NDArray[np.float64], samples: list[Sample], statistics: Statistics
) -> NDArray[np.float64]:
    """Each scene's normalised RMSE over its five Ward parameters.

    Args:
        estimates: (S, 5) Ward parameters.
        samples: S scenes with their truth.
        statistics: Mean and standard deviation of the training set.

    Returns:
        (S,) float64.
    """
    truths = np.stack([sample.ward for sample in samples])
    squared = _squared_errors(estimates, truths, statistics)
    return np.asarray(np.sqrt(squared.mean(axis=1)), np.float64)


def _squared_errors(
    estimates: NDArray[np.float64], truths: NDArray[np.float64], statistics: Statistics
) -> NDArray[np.float64]:
    """(S, 5) of the z-scored parameters."""
    known = statistics["ward"]
    errors = known.normalise(estimates) - known.normalise(truths)
    return np.asarray(errors**2, np.float64)
