# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is thought of light and albedo before the surface is asked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.nonnegative import nonnegative_minimum
from reflest_core.features.light.patch_grid import PATCHES

ALBEDO = (0.3, 0.4)
"""Prior mean and standard deviation of ``rho_d``."""
DARKEST_ALBEDO = 0.02
"""The prior's widths are in units of ``rho_d``, but of no less than this."""
NEGLIGIBLE = 1e-4
"""Of the strongest response: what answers less to a patch tells nothing of it."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LightPrior:
    """Mean and standard deviation of what a patch holds.

    ``unseen``: in multiples of its smooth fill. ``excess``: radiance above white where clipped, in
    multiples of white.
    """

    unseen: tuple[float, float]
    excess: tuple[float, float] = (3.0, 12.0)

    @property
    def mean(self) -> Array:
        """(2 P,), of unseen light and of the excess."""
        return np.repeat([self.unseen[0], self.excess[0]], PATCHES)

    @property
    def width(self) -> Array:
        """(2 P,) standard deviations."""
        return np.repeat([self.unseen[1], self.excess[1]], PATCHES)


EVEN = LightPrior((1.0, 1.2))
"""Unseen light is about as bright as what was seen beside it."""
FREE = LightPrior((3.0, 6.0))
"""It may be a bright sky above a scan that only ever looked down."""
BRIGHT = LightPrior((5.0, 10.0))
"""It usually is, and reflections will tell where."""


def which_matter(columns: NDArray[np.floating]) -> NDArray[np.bool_]:
    """(1 + 2 P,): of which unknowns a system with ``columns`` (R, 1 + 2 P) says anything."""
    strongest = columns.max(axis=0, initial=0.0)
    matters = strongest > NEGLIGIBLE * max(float(strongest.max()), 1e-9)
    matters[0] = True
    return np.asarray(matters)


@dataclass(frozen=True)
class Unknowns:
    """``rho_d`` of one channel and, in units of it, what each patch of light holds.

    ``matters``: see :func:`which_matter`.
    """

    matters: NDArray[np.bool_]
    prior: LightPrior

    def expected(self, albedo: float) -> Array:
        """What the prior expects at this ``rho_d``, of the unknowns that matter."""
        return albedo * np.concatenate([[1.0], self.prior.mean])[self.matters]

    def factors(self, found: Array) -> Array:
        """(2 P,): what each patch holds; the prior's mean where nothing is said of it."""
        factors = self.prior.mean
        factors[self.matters[1:]] = found[1:] / max(float(found[0]), 1e-3)
        return factors

    def most_likely(
        self, data_matrix: Array, data_vector: Array, start: Array
    ) -> tuple[Array, Array]:
        """The unknowns under prior and data, none negative, and the whole system's matrix.

        ``data_matrix``, ``data_vector``: normal equations of the unknowns that matter. ``start``:
        the last answer, whose albedo sets the prior's widths.
        """
        mean = self.prior.mean[self.matters[1:]]
        width = self.prior.width[self.matters[1:]]
        precision = 1.0 / (width * max(float(start[0]), DARKEST_ALBEDO)) ** 2
        matrix, vector = data_matrix.copy(), data_vector.copy()
        diagonal = np.arange(1, len(matrix))
        matrix[diagonal, diagonal] += precision
        matrix[0, 1:] -= precision * mean
        matrix[1:, 0] -= precision * mean
        matrix[0, 0] += (precision * mean**2).sum() + ALBEDO[1] ** -2
        vector[0] += ALBEDO[0] * ALBEDO[1] ** -2
        return nonnegative_minimum(matrix, vector, start), matrix


def log_albedo_deviation(found: Array, matrix: Array) -> float:
    """The standard deviation of ``log rho_d`` that the system leaves."""
    free = found > 0.0
    free[0] = True
    corner = np.eye(int(free.sum()), 1)[:, 0]
    variance = np.linalg.solve(matrix[np.ix_(free, free)], corner)[0]
    return float(np.sqrt(variance)) / max(float(found[0]), 1e-3)
