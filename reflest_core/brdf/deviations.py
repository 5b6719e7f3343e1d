# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Standard deviations of Lab/c,d from those of a Ward BRDF."""

from __future__ import annotations

import itertools
import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.brdf.parameters import ALPHA, PARAMETERS, SMALLEST_ALPHA

NODES = 3
"""Of Gauss-Hermite quadrature along each of the five axes: exact for polynomials of degree 5."""


def labcd_stddev(
    ward: NDArray[np.float64],
    stddev: NDArray[np.float64],
    correlation: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Propagate the standard deviations of a Ward BRDF to Lab and gloss.

    The errors are taken to be normal, and values beyond the physical ranges to be at their ends.
    By quadrature, for Lab and ``c`` bend too sharply near black for a tangent.

    Args:
        ward: (5,) Ward vector.
        stddev: (5,) standard deviations of its values.
        correlation: (5, 5) of their errors; none unless given.

    Returns:
        (5,) standard deviations of ``L, a, b, c, d``.
    """
    points, weights = _quadrature()
    if correlation is not None:
        points = points @ _square_root(correlation).T
    drawn = ward + points * stddev
    drawn[:, :ALPHA] = np.clip(drawn[:, :ALPHA], 0.0, 1.0)
    drawn[:, ALPHA] = np.maximum(drawn[:, ALPHA], SMALLEST_ALPHA)
    labcd = ward_to_labcd(drawn)
    variances: NDArray[np.float64] = weights @ (labcd - weights @ labcd) ** 2
    return np.sqrt(variances)


@cache
def _quadrature() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points (243, 5) and weights (243,) of the five-dimensional standard normal distribution."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(NODES)
    weights = weights / math.sqrt(2.0 * math.pi)
    return (
        np.array(list(itertools.product(nodes, repeat=len(PARAMETERS)))),
        np.array([math.prod(some) for some in itertools.product(weights, repeat=len(PARAMETERS))]),
    )


def _square_root(correlation: NDArray[np.float64]) -> NDArray[np.float64]:
    """(5, 5) ``S`` with ``S S^T`` the nearest positive semidefinite matrix."""
    values, vectors = np.linalg.eigh(correlation)
    root: NDArray[np.float64] = vectors * np.sqrt(np.maximum(values, 0.0))
    return root
