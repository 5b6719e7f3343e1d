# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Agreement of a segmentation with the truth: adjusted Rand index, purity, completeness.

All of them are functions of the contingency table, whose rows are true materials and whose columns
are found ones.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def contingency(truth: NDArray[np.integer], found: NDArray[np.integer]) -> NDArray[np.float64]:
    """Count the points of each pair of labels.

    Args:
        truth: (N,) true labels.
        found: (N,) found labels.

    Returns:
        (R, C) counts; rows and columns in rising order of the labels that occur.
    """
    rows, row = np.unique(truth, return_inverse=True)
    columns, column = np.unique(found, return_inverse=True)
    counts = np.bincount(row * len(columns) + column, minlength=len(rows) * len(columns))
    return counts.reshape(len(rows), len(columns)).astype(np.float64)


def balanced(table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weight all true materials alike, as if each had been observed at as many points.

    Args:
        table: (R, C) contingency table.

    Returns:
        (R, C) with the same total and rows of equal sums.
    """
    sums = table.sum(axis=1, keepdims=True)
    weighted: NDArray[np.float64] = table / sums * (table.sum() / len(table))
    return weighted


def adjusted_rand_index(table: NDArray[np.float64]) -> float:
    """Adjusted Rand index (Hubert and Arabie 1985): 1 for equal partitions, 0 for chance.

    Args:
        table: (R, C) contingency table; weights need not be whole.
    """

    def pairs(counts: NDArray[np.float64]) -> float:
        # Fewer than one point makes no pair.
        return float(np.maximum(counts * (counts - 1.0) / 2.0, 0.0).sum())

    together, total = pairs(table), pairs(table.sum(keepdims=True))
    rows, columns = pairs(table.sum(axis=1)), pairs(table.sum(axis=0))
    expected = rows * columns / total if total > 0.0 else 0.0
    most = (rows + columns) / 2.0
    return 1.0 if most == expected else (together - expected) / (most - expected)


def purity(table: NDArray[np.float64]) -> float:
    """Share of points whose found material has their true material as its most frequent one.

    Low where materials were merged.

    Args:
        table: (R, C) contingency table.
    """
    return float(table.max(axis=0).sum() / table.sum())


def completeness(table: NDArray[np.float64]) -> float:
    """Share of points whose true material has their found material as its most frequent one.

    Low where materials were divided.

    Args:
        table: (R, C) contingency table.
    """
    return float(table.max(axis=1).sum() / table.sum())
