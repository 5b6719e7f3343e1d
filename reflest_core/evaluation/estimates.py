# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Estimates of many scenes, each as the live path would make it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.estimator import Estimator
from reflest_core.training.data.sample import Sample


@dataclass(frozen=True)
class SceneEstimates:
    """Of S scenes. ``ward``: (S, 5) physical. ``stddev``: (S, 5), NaN where the network has none.

    ``statuses``: the S names of :class:`EstimateStatus`.
    """

    ward: NDArray[np.float64]
    stddev: NDArray[np.float64]
    statuses: list[str]

    def of(self, rows: NDArray[np.int64]) -> SceneEstimates:
        """Those of some scenes."""
        statuses = [self.statuses[row] for row in rows]
        return SceneEstimates(self.ward[rows], self.stddev[rows], statuses)


def estimate_all(estimator: Estimator, samples: list[Sample], title: str) -> SceneEstimates:
    """Estimates of ``samples``; shows progress under ``title``."""
    progress = tqdm(samples, desc=title, unit="scene", leave=False)
    return gathered(estimator.estimate(sample.surface, 0, "") for sample in progress)


def gathered(made: Iterable[BrdfEstimate]) -> SceneEstimates:
    """Published estimates as arrays."""
    estimates = list(made)
    return SceneEstimates(
        np.array([[*e.rho_d, e.rho_s, e.alpha] for e in estimates]),
        np.array([[*e.rho_d_stddev, e.rho_s_stddev, e.alpha_stddev] for e in estimates]),
        [e.status.name for e in estimates],
    )
