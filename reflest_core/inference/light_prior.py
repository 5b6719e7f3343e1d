# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Priors of light and albedo."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import luminance
from reflest_core.inference.nonnegative import nonnegative_minimum
from reflest_core.inference.transport.patch_grid import PATCHES, patch_directions
from reflest_core.jit import compiled

ALBEDO = (0.3, 0.25)
"""Prior mean and standard deviation of ``rho_d``."""
DARKEST_ALBEDO = 0.02
"""The prior's widths are in units of ``rho_d``, but of no less than this."""
NEGLIGIBLE = 1e-4
"""Of the strongest response: a patch with less has no influence."""
HUE = (0.8, 0.93, 1.34)
"""What is above and unseen, over its fill, in each channel beside the mean of the three: skies are
bluer than what stands below them. The mean of logarithms over the 24 lights of SynBRDF's training.
"""
LEVEL = 0.3
"""Sine of the elevation up to which, above and below, a patch is beside the object."""

DARKEST_FILL, TINTS = 1e-4, (0.2, 5.0)
"""Radiance that a fill has at least, and how far its colour is made grey."""

Array = NDArray[np.float64]
Expected = tuple[float, float]
"""Mean and standard deviation."""


@dataclass(frozen=True)
class PatchPrior:
    """What each patch of light is expected to hold in one channel, P patches.

    Attributes:
        mean: (2 P,), of unseen light in multiples of its fill, and of the excess.
        width: (2 P,) standard deviations.
    """

    mean: Array
    width: Array


@dataclass(frozen=True)
class LightPrior:
    """Mean and standard deviation of what a patch of light holds, by where it is.

    Attributes:
        above: unseen light of patches above the horizon, in multiples of its smooth fill.
        beside: of patches at the horizon.
        below: of patches below it.
        excess: radiance above white where clipped, in multiples of white.
    """

    above: Expected
    beside: Expected
    below: Expected
    excess: Expected = (4.0, 16.0)

    def of_channel(self, channel: int) -> LightPrior:
        """Apply the usual :data:`HUE` of light from above.

        Args:
            channel: 0, 1, 2 for red, green, blue.
        """
        return _of_hue(self, HUE[channel])

    def of_patches(self, channel: int, fill: NDArray[np.floating]) -> PatchPrior:
        """Expect light from above as grey as lamps and clouds are, whatever colour fills it.

        What stands around a scan is often coloured, and the fill takes its colour.

        Args:
            channel: 0, 1, 2 for red, green, blue.
            fill: (P, 3) the mean colour of each patch's fill, linear.
        """
        prior = self.of_channel(channel)
        grey = luminance(np.maximum(fill, DARKEST_FILL)) / np.maximum(
            fill[:, channel], DARKEST_FILL
        )
        ratio = np.where(patch_directions()[:, 2] > LEVEL, np.clip(grey, *TINTS), 1.0)
        both = np.concatenate([ratio, np.ones(PATCHES)])
        return PatchPrior(prior.mean * both, prior.width * both)

    @cached_property
    def mean(self) -> Array:
        """(2 P,), of unseen light and of the excess."""
        return self._of_patches(0)

    @cached_property
    def width(self) -> Array:
        """(2 P,) standard deviations."""
        return self._of_patches(1)

    def _of_patches(self, which: int) -> Array:
        heights = patch_directions()[:, 2]
        unseen = np.select(
            [heights > LEVEL, heights < -LEVEL],
            [self.above[which], self.below[which]],
            self.beside[which],
        )
        return np.concatenate([unseen, np.full(PATCHES, self.excess[which])])


@cache
def _of_hue(prior: LightPrior, hue: float) -> LightPrior:
    mean, deviation = prior.above
    return dataclasses.replace(prior, above=(hue * mean, hue * deviation))


BRIGHT = LightPrior((6.0, 10.0), (2.5, 5.0), (1.2, 1.5))
"""What an orbit does not see is above, and usually bright: a sky, a lamp, a window."""
SCENE = LightPrior((6.0, 20.0), (2.5, 10.0), (1.2, 3.0))
"""The same for several materials, whose colours together constrain the light's strength more. Over
24 lights that strength errs by 0.18 in its logarithm, with :data:`BRIGHT` by more
(``scripts/light_strength.py``, docs/research/material-trials.md)."""
DIM = LightPrior((2.0, 4.0), (1.5, 2.7), (1.0, 1.3), (4.0, 21.0))
"""As if it were dim: how much the albedo then differs says how far it depends on the prior."""


def which_matter(columns: NDArray[np.floating]) -> NDArray[np.bool_]:
    """Find the unknowns that the observations respond to.

    Args:
        columns: (R, 1 + 2 P) responses to the albedo and to each part of the light.

    Returns:
        (1 + 2 P,) True where the response is not negligible; always for the albedo.
    """
    strongest = columns.max(axis=0, initial=0.0)
    matters = strongest > NEGLIGIBLE * max(float(strongest.max()), 1e-9)
    matters[0] = True
    return np.asarray(matters)


@dataclass(frozen=True)
class Unknowns:
    """``rho_d`` of one channel and, in units of it, what each patch of light holds.

    Attributes:
        matters: (1 + 2 P,) of :func:`which_matter`.
        prior: of the light.
    """

    matters: NDArray[np.bool_]
    prior: LightPrior

    @cached_property
    def _expected(self) -> tuple[Array, Array]:
        """Mean and width (U - 1,) of the patches that matter."""
        return self.prior.mean[self.matters[1:]], self.prior.width[self.matters[1:]]

    def expected(self, albedo: float) -> Array:
        """Return the unknowns' prior mean.

        Args:
            albedo: ``rho_d`` of the channel.

        Returns:
            (U,) of the unknowns that matter.
        """
        return albedo * np.concatenate([[1.0], self.prior.mean])[self.matters]

    def factors(self, found: Array) -> Array:
        """Return what each patch holds.

        Args:
            found: (U,) the unknowns that matter.

        Returns:
            (2 P,); the prior's mean where the observations do not respond.
        """
        factors = self.prior.mean.copy()
        factors[self.matters[1:]] = found[1:] / max(float(found[0]), 1e-3)
        return factors

    def most_likely(self, matrix: Array, vector: Array, start: Array) -> tuple[Array, Array]:
        """Find the nonnegative unknowns that are most likely under prior and observations.

        Args:
            matrix: (U, U) the observations' normal matrix, see :func:`normal_equations`.
            vector: (U,) their normal equations' right side.
            start: (U,) the last solution, whose albedo sets the prior's widths.

        Returns:
            The unknowns (U,) and the normal matrix (U, U), prior included.
        """
        mean, width = self._expected
        return _most_likely(matrix, vector, mean, width, start)


@compiled
def _most_likely(
    matrix: Array, vector: Array, mean: Array, width: Array, start: Array
) -> tuple[Array, Array]:
    """Add the priors of the light, of ``mean`` and ``width`` (U - 1,), and of the albedo; solve."""
    matrix, vector = matrix.copy(), vector.copy()
    albedo = max(start[0], DARKEST_ALBEDO)
    for n in range(len(mean)):
        precision = 1.0 / (width[n] * albedo) ** 2
        matrix[n + 1, n + 1] += precision
        matrix[0, n + 1] -= precision * mean[n]
        matrix[n + 1, 0] -= precision * mean[n]
        matrix[0, 0] += precision * mean[n] ** 2
    matrix[0, 0] += ALBEDO[1] ** -2
    vector[0] += ALBEDO[0] * ALBEDO[1] ** -2
    return nonnegative_minimum(matrix, vector, start), matrix


def normal_equations(
    columns: NDArray[np.float32], target: NDArray[np.float32], weight: NDArray[np.float32]
) -> tuple[Array, Array]:
    """Multiply out the least squares of responses that should add up to a target.

    Args:
        columns: (R, U) responses to U unknowns.
        target: (R,) what they should add up to.
        weight: (R,) its inverse variance.

    Returns:
        The matrix (U, U) and the vector (U,).
    """
    root = np.sqrt(weight)
    weighted = columns * root[:, None]
    return (
        (weighted.T @ weighted).astype(np.float64),
        (weighted.T @ (target * root)).astype(np.float64),
    )


def log_albedo_deviation(found: Array, matrix: Array) -> float:
    """Return the standard deviation of ``log rho_d``.

    Args:
        found: (U,) the solution.
        matrix: (U, U) the normal matrix.
    """
    return float(np.sqrt(1.0 / _last_pivot(matrix, found))) / max(float(found[0]), 1e-3)


@compiled
def _last_pivot(matrix: Array, found: Array) -> float:
    """The inverse of the inverse matrix' first element, of the unknowns that are not held at 0."""
    rest = matrix.copy()
    for k in range(len(found) - 1, 0, -1):
        if found[k] > 0.0:
            for i in range(k):
                factor = rest[i, k] / rest[k, k]
                for j in range(k):
                    rest[i, j] -= factor * rest[k, j]
    return float(rest[0, 0])
