# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The scenes with the largest errors, and the measures in which they are unusual."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import ALPHA, RHO_D, RHO_S
from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.evaluation.estimates import SceneEstimates
from reflest_core.evaluation.statistics.scene_measures import UNUSUAL_SHARE, measured, unusual
from reflest_core.models.card import WARD_NAMES, ParameterStatistics
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.sample import Sample

SHOWN = 10
ONE_PARAMETER = 0.6
"""A parameter with this share of the squared error is named alone."""


def find_failures(
    made: SceneEstimates,
    scenes: list[SynbrdfScene],
    samples: list[Sample],
    statistics: ParameterStatistics,
) -> dict[str, Any]:
    """Find the :data:`SHOWN` scenes with the largest normalised RMSE.

    Args:
        made: Estimates with standard deviations.
        scenes: The scenes of the split.
        samples: The same with their truth.
        statistics: Mean and standard deviation of the training set (Ward parameters).

    Returns:
        The record of the part ``failures``; the worst scene comes first.
    """
    truths = np.stack([sample.ward for sample in samples])
    squared = ((made.ward - truths) / statistics.stddev) ** 2
    errors = np.sqrt(squared.mean(axis=1))
    worst = np.argsort(-errors, kind="stable")[:SHOWN]
    of_split = [measured(sample) for sample in samples]
    expected = np.sqrt(((made.stddev / statistics.stddev) ** 2).mean(axis=1))
    return {
        "scenes": len(samples),
        "rmse": float(np.sqrt(squared.mean())),
        "without_them": float(np.sqrt(np.delete(squared, worst, axis=0).mean()))
        if len(samples) > len(worst)
        else None,
        "failures": [
            {
                "row": row,
                "index": scenes[row].index,
                "environment": scenes[row].environment,
                "shape": scenes[row].shape,
                "view_pattern": scenes[row].view_pattern,
                "error": float(errors[row]),
                "expected_error": float(expected[row]),
                "status": made.statuses[row],
                "truth": truths[row].tolist(),
                "estimate": made.ward[row].tolist(),
                "stddev": made.stddev[row].tolist(),
                "measures": of_split[row],
                "reasons": [
                    _where(squared[row]),
                    *unusual(of_split[row], of_split),
                    _of_environment(row, samples, squared),
                    _foreseen(row, expected, made.statuses[row]),
                ],
            }
            for row in worst.tolist()
        ],
    }


def _where(squared: NDArray[np.float64]) -> str:
    """Which parameters hold most of one scene's squared error (5,)."""
    shares = squared / max(float(squared.sum()), 1e-12)
    albedo, most = float(shares[RHO_D].sum()), int(shares.argmax())
    if most >= 3 and shares[most] >= ONE_PARAMETER:
        return f"{WARD_NAMES[most]} holds {shares[most]:.0%} of the squared error"
    if albedo >= ONE_PARAMETER:
        return f"rho_d holds {albedo:.0%} of the squared error"
    return (
        f"the squared error is spread: rho_d {albedo:.0%}, rho_s {shares[RHO_S]:.0%}, alpha "
        f"{shares[ALPHA]:.0%}"
    )


def _of_environment(row: int, samples: list[Sample], squared: NDArray[np.float64]) -> str:
    """How the other scenes under the same light fare."""
    name = samples[row].environment
    under = np.array([sample.environment == name for sample in samples])
    under[row] = False
    if not under.any():
        return f"no other scene stands in {name}"
    rmse, overall = float(np.sqrt(squared[under].mean())), float(np.sqrt(squared.mean()))
    return (
        f"the other {int(under.sum())} scenes in {name} have RMSE {rmse:.2f}, all scenes "
        f"{overall:.2f}"
    )


def _foreseen(row: int, expected: NDArray[np.float64], status: str) -> str:
    """Whether the estimate itself said so."""
    rank = float((expected < expected[row]).mean())
    surprise = "foreseen" if rank >= 1.0 - UNUSUAL_SHARE else "not foreseen"
    said = "no status" if status == EstimateStatus.OK.name else f"status {status}"
    return (
        f"{surprise}: by its own deviations an error of {expected[row]:.2f} was expected, more "
        f"than in {rank:.0%} of the scenes, with {said}"
    )
