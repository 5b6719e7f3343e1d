# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Non-negative least squares of some dozens of unknowns, by coordinate descent."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import fused

SWEEPS = 200
TOLERANCE = 1e-4
"""A sweep that moves no unknown by more than this share of the largest one is the last."""


@fused
def nonnegative_minimum(
    matrix: NDArray[np.float64], vector: NDArray[np.float64], start: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Minimise ``x' matrix x / 2 - vector' x`` over ``x >= 0``.

    Every unknown in turn takes its best value while the others stay (Franc et al. 2005, "Sequential
    Coordinate-wise Algorithm for the Non-negative Least Squares Problem").

    Args:
        matrix: (N, N) positive definite.
        vector: (N,).
        start: (N,) where to begin.

    Returns:
        (N,) the minimum.
    """
    x = np.maximum(start, 0.0)
    slope = -vector
    for i in range(len(x)):  # "matrix @ x" would be left to a BLAS with threads of its own
        slope += x[i] * matrix[i]
    for _ in range(SWEEPS):
        moved = 0.0
        for i in range(len(x)):
            value = max(x[i] - slope[i] / matrix[i, i], 0.0)
            step = value - x[i]
            if step != 0.0:
                x[i] = value
                for j in range(len(x)):
                    slope[j] += step * matrix[i, j]
                moved = max(moved, abs(step))
        if moved <= TOLERANCE * x.max():
            break
    return x
