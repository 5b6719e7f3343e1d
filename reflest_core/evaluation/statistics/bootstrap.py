# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Percentile intervals of errors over resampled scenes or environments (Efron's bootstrap)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

DRAWS = 2000
SEED = 20171


@dataclass(frozen=True)
class Interval:
    """The central 95 % of the bootstrap's draws.

    Attributes:
        low: 2.5th percentile.
        high: 97.5th percentile.
    """

    low: float
    high: float


def over_scenes(squared: NDArray[np.float64]) -> Interval:
    """Interval of a root mean squared error, scenes resampled.

    Args:
        squared: (S,) mean squared error of each scene.
    """
    return over_groups(squared, [str(index) for index in range(len(squared))])


def over_groups(squared: NDArray[np.float64], groups: Sequence[str]) -> Interval:
    """Interval of a root mean squared error, groups of scenes resampled.

    Errors under one environment are correlated, so that this interval is the wider one, and the
    valid one for new environments.

    Args:
        squared: (S,) mean squared error of each scene.
        groups: S names of groups, such as environments.
    """
    return _central(np.sqrt(_means(squared[:, None], groups)[:, 0]))


def mean_of_roots_over_groups(squared: NDArray[np.float64], groups: Sequence[str]) -> Interval:
    """Interval of the mean over parameters of root mean squared errors, groups resampled.

    Args:
        squared: (S, P) squared errors.
        groups: S names of groups.
    """
    return _central(np.sqrt(_means(squared, groups)).mean(axis=1))


def share_over_groups(is_so: NDArray[np.bool_], groups: Sequence[str]) -> Interval:
    """Interval of a share of scenes, groups resampled.

    Args:
        is_so: (S,) bool, the scenes that count.
        groups: S names of groups.
    """
    return _central(_means(is_so.astype(np.float64)[:, None], groups)[:, 0])


def _means(values: NDArray[np.float64], groups: Sequence[str]) -> NDArray[np.float64]:
    """(DRAWS, P) means of (S, P) over scenes of groups drawn with replacement."""
    names, member = np.unique(np.asarray(groups), return_inverse=True)
    sums = np.stack([np.bincount(member, weights=column) for column in values.T], axis=1)
    counts = np.bincount(member)
    drawn = np.random.default_rng(SEED).integers(0, len(names), (DRAWS, len(names)))
    means: NDArray[np.float64] = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)[:, None]
    return means


def _central(means: NDArray[np.float64]) -> Interval:
    low, high = np.percentile(means, [2.5, 97.5])
    return Interval(float(low), float(high))
