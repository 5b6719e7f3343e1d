# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The error by parameter, by gloss and by environment."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import ALPHA, RHO_S
from reflest_core.evaluation.statistics.accuracy import Statistics
from reflest_core.training.data.sample import Sample

GROUPS = 5
"""Fifths of the scenes, by true specular albedo."""


def break_down(
    estimates: NDArray[np.float64], samples: list[Sample], statistics: Statistics
) -> dict[str, Any]:
    """Split the error of estimates.

    Args:
        estimates: (S, 5) Ward parameters.
        samples: S scenes with their truth.
        statistics: Mean and standard deviation of the training set.

    Returns:
        ``parameter_shares`` of the squared error, RMSE by ``fifths`` of the true ``rho_s``, and
        RMSE by ``environments``, best first.
    """
    truths = np.stack([sample.ward for sample in samples])
    known = statistics["ward"]
    squared = (known.normalise(estimates) - known.normalise(truths)) ** 2
    fifths = np.array_split(np.argsort(truths[:, RHO_S], kind="stable"), GROUPS)
    lights = np.array([sample.environment for sample in samples])
    by_light = [
        {
            "environment": name,
            "scenes": int((lights == name).sum()),
            "rmse": _root(squared[lights == name]),
        }
        for name in np.unique(lights).tolist()
    ]
    return {
        "parameter_shares": (squared.mean(axis=0) / squared.mean() / 5).tolist(),
        "fifths": [
            {
                "rho_s": [float(truths[group, RHO_S].min()), float(truths[group, RHO_S].max())],
                "rmse": _root(squared[group]),
                "alpha_rmse": _root(squared[group, ALPHA]),
            }
            for group in fifths
            if len(group)
        ],
        "environments": sorted(by_light, key=lambda row: row["rmse"]),
    }


def _root(squared: NDArray[np.float64]) -> float:
    return float(np.sqrt(squared.mean()))
