# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One colour channel of all segments in one light: the least-squares system and its solution.

Every observation of segment ``k`` is

    L = rho_d[k] E(n) / pi + rho_s[k] S(o, n, alpha[k])

with ``E`` and ``S`` linear in what the patches of unseen and clipped light hold. Unknown are
``rho_d`` and ``rho_s`` of each segment and the patches; the system is bilinear, and solved by
Gauss-Newton steps with iteratively reweighted least squares (Cauchy weights for observations and
for the light's prior).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.light_prior import PatchPrior
from reflest_core.inference.nonnegative import nonnegative_minimum
from reflest_core.jit import compiled, kernel_array

RELATIVE, LEAST = 0.05, 0.003
"""Standard deviation of a radiance: share of itself, and in units of the sensor's white."""
COARSE = 0.1
"""The same of what is known of a reflection, as a share of it."""
HIDDEN = 2.0
"""The same of what unknown light adds to a reflection: a patch is not even, and lobes are small."""
GLOSS_SHARE, GLOSS_LEAST = 0.5, 0.02
"""Prior standard deviation of ``rho_s``: share of its first value, and at any value."""
TAIL = 0.1
"""Of the squared width of the light's prior: what remains of it next to the squared distance."""
FIRST_ERROR = 0.3
"""Relative error by which observations are weighted before the model is known."""
LARGEST_STEP, SMALLEST_ALBEDO = 2.5, 0.02
"""``rho_d`` changes by at most this factor in one step, but may always reach this value."""
WEIGHT = 0.1
"""Power of the observations' likelihood beside the priors: neighbours err together."""
EVIDENCE = 0.01
"""Share of the observations that err each for itself; the deviations count no more than these."""
ALBEDO, LOG_ALBEDO = (0.2, 0.3), (math.log(0.12), 3.0)
"""Prior means and standard deviations of ``rho_d``, and of ``ln rho_d`` beside it: measured
materials are more often dark than bright. Several segments are of one material, so that the spread
of the logarithms is greater than that of materials, 1.2."""
MODEL_ERROR = 0.25
"""Standard deviation of ``ln rho_d`` that no number of observations removes."""
DARKEST = 0.003
"""``rho_d`` below which the prior is no narrower."""
NEGLIGIBLE = 1e-4
"""Share of the strongest response below which a patch is left to its prior."""

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]


@dataclass(frozen=True)
class ChannelState:
    """The unknowns of one channel; S segments, P patches.

    Attributes:
        rho_d: (S,).
        rho_s: (S,).
        light: (2 P,) factor to each patch's fill where unseen, radiance above white where clipped.
    """

    rho_d: Array
    rho_s: Array
    light: Array


@dataclass(frozen=True)
class ChannelSolution:
    """The solution of one channel.

    Attributes:
        state: the unknowns.
        log_albedo_deviation: (S,) standard deviation of ``log rho_d``.
        gloss_deviation: (S,) standard deviation of ``rho_s``.
        light_deviation: (2 P,) standard deviations of ``state.light``.
        misfit: root mean square of the observations' relative errors, outliers weighing little.
        condition: condition number (1-norm) of the information with a diagonal of 1, which does
            not depend on units.
    """

    state: ChannelState
    log_albedo_deviation: Array
    gloss_deviation: Array
    light_deviation: Array
    misfit: float
    condition: float


@dataclass(frozen=True)
class ChannelSystem:
    """O observations, grouped by segment, of V voxels.

    Attributes:
        colours: (O,) linear.
        is_clipped: (O,) the colour is a lower bound.
        starts: (S,) first observation of each segment; every segment has one.
        segment_of: (O,) rising.
        voxel_of: (O,) into the rows of ``diffuse``.
        diffuse: (V, 1 + 2 P) response of a white matte voxel: to known light, and to the patches.
        mirrored: (O, 1 + 2 P) the same of what an observation mirrors at ``rho_s = 1``.
        rho_s: (S,) prior mean of each segment's ``rho_s``.
        prior: what the patches may hold.
    """

    colours: Array32
    is_clipped: NDArray[np.bool_]
    starts: NDArray[np.int64]
    segment_of: NDArray[np.int64]
    voxel_of: NDArray[np.int64]
    diffuse: Array32
    mirrored: Array32
    rho_s: Array
    prior: PatchPrior

    def solve(self, start: ChannelState, turns: int, is_found: bool) -> ChannelSolution:
        """Minimise from ``start``.

        Args:
            start: where to begin.
            turns: Gauss-Newton steps.
            is_found: the start is an earlier solution, by which outliers are recognised.
        """
        strongest = np.maximum(self.diffuse.max(axis=0), self.mirrored.max(axis=0, initial=0.0))
        is_free = strongest[1:] > NEGLIGIBLE * max(float(strongest.max()), 1e-9)
        free = 1 + np.flatnonzero(is_free)
        known = self.diffuse[self.voxel_of, 0], self.mirrored[:, 0]
        diffuse = np.take(np.take(self.diffuse, free, axis=1), self.voxel_of, axis=0)
        columns = diffuse, np.take(self.mirrored, free, axis=1)
        mean, width = self.prior.mean[is_free], self.prior.width[is_free]
        segments = len(self.starts)
        x = np.concatenate([start.rho_d, start.rho_s, start.light[is_free]])
        gloss_width = GLOSS_SHARE * self.rho_s + GLOSS_LEAST
        information = np.eye(len(x))
        for turn in range(turns):
            is_first = turn == 0 and not is_found
            normal, vector = self._normal_equations(known, columns, x, is_first)
            light = x[2 * segments :]
            spread = width**2 if is_first else TAIL * width**2 + (light - mean) ** 2
            albedo, albedo_width = _albedo_prior(x[:segments])
            precision = np.concatenate([albedo_width, gloss_width, np.sqrt(spread)]) ** -2.0
            vector = WEIGHT * vector + precision * np.concatenate([albedo, self.rho_s, mean])
            information = EVIDENCE * normal + np.diag(precision)
            found = nonnegative_minimum(WEIGHT * normal + np.diag(precision), vector, x)
            low, high = x[:segments] / LARGEST_STEP, LARGEST_STEP * x[:segments]
            found[:segments] = np.clip(found[:segments], low, np.maximum(high, SMALLEST_ALBEDO))
            found[segments : 2 * segments] = np.minimum(found[segments : 2 * segments], 1.0)
            x = found
        covariance = np.asarray(np.linalg.inv(information), np.float64)
        deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        rho_d, rho_s = x[:segments], x[segments : 2 * segments]
        light, light_deviation = self.prior.mean.copy(), self.prior.width.copy()
        light[is_free] = x[2 * segments :]
        light_deviation[is_free] = deviation[2 * segments :]
        error = self._error(known, columns, x)[~self.is_clipped]
        relative = error / (RELATIVE * self.colours[~self.is_clipped] + LEAST)
        misfit = RELATIVE * float(np.sqrt(np.log1p(relative**2).mean())) if len(error) else 0.0
        return ChannelSolution(
            ChannelState(rho_d, rho_s, light),
            np.hypot(deviation[:segments] / np.maximum(rho_d, SMALLEST_ALBEDO), MODEL_ERROR),
            deviation[segments : 2 * segments],
            light_deviation,
            misfit,
            _condition(information, covariance),
        )

    def _parts(self, x: Array) -> tuple[Array32, Array32, Array32]:
        """``rho_d`` and ``rho_s`` of each observation's segment, and the patches."""
        segments = len(self.starts)
        of_segment = x[: 2 * segments].astype(np.float32).reshape(2, segments)
        rho_d, rho_s = of_segment[:, self.segment_of]
        return rho_d, rho_s, x[2 * segments :].astype(np.float32)

    def _error(
        self, known: tuple[Array32, Array32], columns: tuple[Array32, Array32], x: Array
    ) -> Array32:
        """(O,) model less colour."""
        rho_d, rho_s, light = self._parts(x)
        shaded = known[0] + columns[0] @ light
        shining = known[1] + columns[1] @ light
        return np.asarray(rho_d * shaded + rho_s * shining - self.colours)

    def _normal_equations(
        self,
        known: tuple[Array32, Array32],
        columns: tuple[Array32, Array32],
        x: Array,
        is_first: bool,
    ) -> tuple[Array, Array]:
        """Matrix (U, U) and vector (U,) of the linearised, weighted observations."""
        rho_d, rho_s, light = self._parts(x)
        shaded = known[0] + columns[0] @ light
        unknown = columns[1] @ light
        shining = known[1] + unknown
        model = rho_d * shaded + rho_s * shining
        error = model - self.colours
        variance = (
            (RELATIVE * self.colours + LEAST) ** 2
            + (COARSE * rho_s * known[1]) ** 2
            + (HIDDEN * rho_s * unknown) ** 2
        )
        variance += (FIRST_ERROR * self.colours if is_first else error) ** 2
        is_met = self.is_clipped if is_first else self.is_clipped & (error >= 0.0)
        root = np.where(is_met, np.float32(0.0), 1.0 / np.sqrt(variance))
        shaded, shining = shaded * root, shining * root
        by_patch, cross = _by_patch(
            np.append(self.starts, len(root)),
            kernel_array(np.stack([rho_d * root, rho_s * root, shaded, shining]), np.float32),
            kernel_array(columns[0], np.float32),
            kernel_array(columns[1], np.float32),
        )
        # The step is taken from x, so that the target is what is left over, and what x explains.
        target = shaded * rho_d + shining * rho_s + by_patch @ light - error * root
        segments = len(self.starts)
        matrix = np.zeros((len(x), len(x)))
        vector = np.zeros(len(x))
        i, j = np.arange(segments), segments + np.arange(segments)
        matrix[i, i] = self._sums(shaded * shaded)
        matrix[j, j] = self._sums(shining * shining)
        matrix[i, j] = matrix[j, i] = self._sums(shaded * shining)
        matrix[: 2 * segments, 2 * segments :] = cross
        matrix[2 * segments :, : 2 * segments] = cross.T
        for first, values in ((0, shaded), (segments, shining)):
            vector[first : first + segments] = self._sums(values * target)
        matrix[2 * segments :, 2 * segments :] = by_patch.T @ by_patch
        vector[2 * segments :] = by_patch.T @ target
        return matrix, vector

    def _sums(self, values: Array32) -> Array:
        """(S, ...) sums over each segment's observations (O, ...)."""
        return np.asarray(np.add.reduceat(values, self.starts, axis=0), np.float64)


def _condition(information: Array, covariance: Array) -> float:
    """Condition number of the information, scaled to a diagonal of 1."""
    scale = np.sqrt(np.diag(information))
    scaled, inverse = information / np.outer(scale, scale), covariance * np.outer(scale, scale)
    return float(np.abs(scaled).sum(axis=0).max() * np.abs(inverse).sum(axis=0).max())


@compiled
def _by_patch(
    starts: NDArray[np.int64], factors: Array32, diffuse: Array32, mirrored: Array32
) -> tuple[Array32, Array32]:
    """What each patch adds to the observations, and its products with albedo and gloss.

    ``factors`` (4, O): of ``diffuse`` and ``mirrored`` (O, U) in their sum; then what ``rho_d`` and
    ``rho_s`` add. Returns that sum (O, U), and of it (2 S, U) the sums over each segment's
    observations, weighted by either of the latter. In one pass, for the arrays are large.
    """
    segments, patches = len(starts) - 1, diffuse.shape[1]
    by_patch = np.empty(diffuse.shape, np.float32)
    cross = np.zeros((2 * segments, patches), np.float32)
    for segment in range(segments):
        of_albedo, of_gloss = cross[segment], cross[segments + segment]
        for o in range(starts[segment], starts[segment + 1]):
            row, shading, shining = by_patch[o], diffuse[o], mirrored[o]
            a, b, c, d = factors[0, o], factors[1, o], factors[2, o], factors[3, o]
            for n in range(patches):
                row[n] = a * shading[n] + b * shining[n]
            for n in range(patches):
                of_albedo[n] += c * row[n]
                of_gloss[n] += d * row[n]
    return by_patch, cross


def _albedo_prior(rho_d: Array) -> tuple[Array, Array]:
    """Mean and deviation (S,) of the Gaussians that touch the prior of ``rho_d`` there."""
    (mean, width), (log_mean, spread) = ALBEDO, LOG_ALBEDO
    held = np.maximum(rho_d, DARKEST)
    by_log = held * (1.0 + np.clip(log_mean - np.log(held), -1.0, 1.0))
    own, other = width**-2.0, (spread * held) ** -2.0
    return (own * mean + other * by_log) / (own + other), (own + other) ** -0.5
