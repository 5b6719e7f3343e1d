# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Normalised RMSE of estimates on a split, with how sure it is: one row of Table 2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.evaluation.bootstrap import Interval, over_groups, over_scenes
from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.training.metrics import NormalisedRmse, normalised_rmse
from reflest_core.training.sample import Sample

Statistics = dict[str, ParameterStatistics]
"""The training set's, for ``ward`` and for ``labcd``."""


@dataclass(frozen=True)
class Accuracy:
    """``ward``, ``labcd``: the errors in both parameterisations.

    ``over_scenes``, ``over_environments``: 95 % intervals of ``ward.overall``.
    """

    scenes: int
    environments: int
    ward: NormalisedRmse
    labcd: NormalisedRmse
    over_scenes: Interval
    over_environments: Interval


def accuracy(
    estimates: NDArray[np.float64], samples: list[Sample], statistics: Statistics
) -> Accuracy:
    """Of (S, 5) Ward estimates of ``samples``."""
    truths = np.stack([sample.ward for sample in samples])
    environments = [sample.environment for sample in samples]
    squared = scene_errors(estimates, samples, statistics) ** 2
    return Accuracy(
        scenes=len(samples),
        environments=len(set(environments)),
        ward=normalised_rmse(estimates, truths, statistics["ward"]),
        labcd=normalised_rmse(ward_to_labcd(estimates), ward_to_labcd(truths), statistics["labcd"]),
        over_scenes=over_scenes(squared),
        over_environments=over_groups(squared, environments),
    )


def scene_errors(
    estimates: NDArray[np.float64], samples: list[Sample], statistics: Statistics
) -> NDArray[np.float64]:
    """(S,) each scene's normalised RMSE over its five Ward parameters."""
    truths = np.stack([sample.ward for sample in samples])
    known = statistics["ward"]
    errors = known.normalise(estimates) - known.normalise(truths)
    roots: NDArray[np.float64] = np.sqrt((errors**2).mean(axis=1))
    return roots
