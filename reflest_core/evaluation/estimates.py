# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Estimates of many scenes, each as the live path makes it, and the file that keeps them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.estimator import Estimator
from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.record_file import read_record
from reflest_core.training.data.sample import Sample


@dataclass(frozen=True)
class SceneEstimates:
    """Estimates of S scenes.

    Attributes:
        ward: (S, 5) float64, ``rho_d`` (linear sRGB), ``rho_s``, ``alpha``.
        stddev: (S, 5) float64, standard deviations; NaN where the network states none.
        statuses: S names of :class:`EstimateStatus`.
    """

    ward: NDArray[np.float64]
    stddev: NDArray[np.float64]
    statuses: list[str]

    def of(self, rows: NDArray[np.int64]) -> SceneEstimates:
        """The estimates of some scenes.

        Args:
            rows: (R,) int64, indices of scenes.
        """
        statuses = [self.statuses[row] for row in rows]
        return SceneEstimates(self.ward[rows], self.stddev[rows], statuses)


Estimates = dict[str, dict[str, SceneEstimates]]
"""By split and network."""


def estimate_all(estimator: Estimator, samples: list[Sample], title: str) -> SceneEstimates:
    """Estimate the material of every sample.

    Args:
        estimator: The live path after the store.
        samples: S scenes.
        title: The label of the progress bar.

    Returns:
        The estimates, in the order of ``samples``.
    """
    progress = tqdm(samples, desc=title, unit="scene", leave=False)
    return gathered(estimator.estimate(sample.surface, 0, "") for sample in progress)


def gathered(made: Iterable[BrdfEstimate]) -> SceneEstimates:
    """Published estimates as arrays.

    Args:
        made: One estimate for each scene.
    """
    estimates = list(made)
    return SceneEstimates(
        np.array([[*e.rho_d, e.rho_s, e.alpha] for e in estimates]),
        np.array([[*e.rho_d_stddev, e.rho_s_stddev, e.alpha_stddev] for e in estimates]),
        [e.status.name for e in estimates],
    )


def as_figures(estimates: Estimates, splits: dict[str, list[Sample]]) -> dict[str, Any]:
    """The estimates behind Table 2 as a record, which other parts read.

    Args:
        estimates: By split and network.
        splits: The scenes of each split.

    Returns:
        By split: ``truths``, the scenes' ``indices`` and the estimates of each network.
    """
    return {
        split: {
            "truths": [sample.ward.tolist() for sample in samples],
            "indices": [sample.index for sample in samples],
            "networks": {name: _plain(made) for name, made in estimates[split].items()},
        }
        for split, samples in splits.items()
    }


def read_estimates(path: Path) -> Estimates:
    """Read a record of :func:`as_figures`.

    Args:
        path: the file.

    Raises:
        EvaluationError: there is no such file, or it is damaged.
    """
    record = read_record(path)
    if record is None:
        raise EvaluationError("there are no estimates yet; run --parts table-2 first")
    return {
        split: {name: _arrays(made) for name, made in of["networks"].items()}
        for split, of in record.items()
        if split != "provenance"
    }


def _plain(made: SceneEstimates) -> dict[str, Any]:
    is_sure = not np.isnan(made.stddev).any()
    return {
        "ward": made.ward.round(6).tolist(),
        "stddev": made.stddev.round(6).tolist() if is_sure else None,
        "statuses": made.statuses,
    }


def _arrays(made: dict[str, Any]) -> SceneEstimates:
    ward = np.array(made["ward"])
    stddev = np.full_like(ward, np.nan) if made["stddev"] is None else np.array(made["stddev"])
    return SceneEstimates(ward, stddev, made["statuses"])
