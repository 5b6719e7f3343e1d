# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The likelihood of a roughness: every observation under it, with Student-t errors.

Within a voxel and channel, ``colour = diffuse + rho_s * (lobe + excess * clipped_lobe)``. The
diffuse radiance is free in each voxel and channel, so that neither albedo nor diffuse light
matters; ``rho_s`` and the ``excess`` of clipped light above white belong to all voxels together.
Both are found by iteratively reweighted least squares (Lange et al. 1989, "Robust Statistical
Modeling Using the t Distribution"), with the diffuse radiances eliminated voxel by voxel. A clipped
colour is a lower bound: its likelihood is the probability of anything brighter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.inference.gloss.colour_noise import HIGHLIGHT_ERROR, colour_variances
from reflest_core.inference.gloss.lobes import EXCESS
from reflest_core.jit import compiled

FREEDOM = 4.0
"""Degrees of freedom of the errors."""
ROUNDS, FURTHER_ROUNDS = 10, 4
"""Of reweighting: at the first roughness, and at each other, which begins where the one before it
ended."""
FIRST_GLOSS = 0.05
"""``rho_s`` that the iteration starts from."""
EXCESS_MEAN, EXCESS_SPREAD = math.log1p(4.0), 1.5
"""Prior of ``ln(1 + excess)``: mean and standard deviation."""
EXCESS_WEIGHT = 6.0
"""Observations that agree as closely as independent ones would; the prior counts as so many."""
LEAST_GLOSS, LEAST_EXCESS = 1e-6, 0.1
LEAST_CLIPPED = 1e-4
"""Share of a lobe: with less clipped light in every lobe there is no excess to be found."""
WHITE = 1.0
"""Diffuse radiance to begin with where every observation is clipped, in units of white."""
MAXIMUM = 3.0 / 8.0
"""Of the density at scale 1, for four degrees of freedom."""
SMALLEST_TAIL = 1e-6


@dataclass(frozen=True)
class GlossFits:
    """The best fit at each of K roughnesses, of V voxels.

    Attributes:
        rho_s: (K,).
        excess: (K,) radiance of clipped light above white, in units of white.
        diffuse: (K, V, 3) diffuse radiances.
        of_voxels: (K, V) log-likelihood of each voxel's observations.
        log_prior: (K,) logarithm of the excess' prior.
        matte: Log-likelihood of all observations at ``rho_s = 0``.
    """

    rho_s: NDArray[np.float64]
    excess: NDArray[np.float64]
    diffuse: NDArray[np.float64]
    of_voxels: NDArray[np.float64]
    log_prior: NDArray[np.float64]
    matte: float


def fit_gloss(
    colours: NDArray[np.uint8],
    offsets: NDArray[np.int64],
    lobes: NDArray[np.float32],
    trust: NDArray[np.float64],
) -> GlossFits:
    """Fit ``rho_s`` at each roughness to the same O observations.

    Args:
        colours: (O, 3) 8-bit sRGB, grouped by voxel.
        offsets: (V + 1,) int64; voxel v owns the observations ``offsets[v]:offsets[v + 1]``.
        lobes: (K, O, 7), see :func:`.lobe_light`.
        trust: (O,) weight of each observation, the same for all roughnesses.

    Returns:
        The fits.
    """
    roughnesses, voxels = len(lobes), len(offsets) - 1
    linear, is_clipped = srgb.LINEAR[colours], colours == 255
    variances = colour_variances().astype(np.float32)[colours]
    found = np.zeros((roughnesses, 3))
    diffuse, of_voxels = np.zeros((roughnesses, voxels, 3)), np.zeros((roughnesses, voxels))

    radiances, matte, start = np.full((voxels, 3), np.nan), np.zeros(voxels), (0.0, 0.0)
    observed = (linear, is_clipped, variances, trust, offsets)
    fit_at_roughness(*observed, lobes[0], start, ROUNDS, True, radiances, matte)
    radiances[:] = np.nan
    has_excess = float(lobes[..., EXCESS:].max(initial=0.0)) > LEAST_CLIPPED
    least = LEAST_EXCESS if has_excess else 0.0
    start, rounds = (FIRST_GLOSS, math.expm1(EXCESS_MEAN) if has_excess else 0.0), ROUNDS
    for k in range(roughnesses):
        found[k] = fit_at_roughness(
            *observed, lobes[k], start, rounds, False, radiances, of_voxels[k]
        )
        start, rounds = (found[k, 0], max(found[k, 1], least)), FURTHER_ROUNDS
        diffuse[k] = radiances
    rho_s, excess, log_prior = found.T
    return GlossFits(rho_s, excess, diffuse, of_voxels, log_prior, float(matte.sum()))


@compiled
def fit_at_roughness(
    colours: NDArray[np.float32],
    is_clipped: NDArray[np.bool_],
    variances: NDArray[np.float32],
    trust: NDArray[np.float64],
    offsets: NDArray[np.int64],
    lobes: NDArray[np.float32],
    start: tuple[float, float],
    rounds: int,
    is_matte: bool,
    diffuse: NDArray[np.float64],
    likelihoods: NDArray[np.float64],
) -> tuple[float, float, float]:
    """Fit ``rho_s`` and the excess of clipped light at one roughness.

    Args:
        colours: (O, 3) linear, grouped by voxel.
        is_clipped: (O, 3) channels at 255.
        variances: (O, 3) of the colours' noise.
        trust: (O,) weight of each observation, the same for all roughnesses.
        offsets: (V + 1,) voxel v owns observations ``offsets[v]:offsets[v + 1]``.
        lobes: (O, 7), see :func:`.lobe_light`.
        start: ``rho_s`` and excess to begin with; an excess of 0 stays 0.
        rounds: Of reweighting.
        is_matte: Whether ``rho_s`` is held at 0.
        diffuse: (V, 3) diffuse radiances to begin with, NaN where unknown; takes those found.
        likelihoods: (V,), takes each voxel's log-likelihood.

    Returns:
        ``rho_s``, the excess, and the logarithm of the excess' prior.
    """
    gloss, excess = start
    has_excess = excess > 0.0
    sums = np.zeros((len(diffuse), 3, 4))
    for _ in range(rounds):
        matrix, vector = _equations(
            colours,
            is_clipped,
            variances,
            lobes,
            trust,
            offsets,
            gloss,
            excess,
            diffuse,
            sums,
        )
        if not is_matte:
            gloss, excess = _stepped(matrix, vector, gloss, excess, has_excess)
        for v in range(len(diffuse)):
            for c in range(3):
                if sums[v, c, 0] <= 0.0:  # all clipped and explained, or nothing counts
                    diffuse[v, c] = WHITE if math.isnan(diffuse[v, c]) else diffuse[v, c]
                else:
                    lobe = sums[v, c, 1] + excess * sums[v, c, 2]
                    diffuse[v, c] = max((sums[v, c, 3] - gloss * lobe) / sums[v, c, 0], 0.0)
    for v in range(len(diffuse)):
        likelihoods[v] = 0.0
        for o in range(offsets[v], offsets[v + 1]):
            product = 1.0  # of the channels' densities, for one logarithm of all
            for c in range(3):
                lobe = lobes[o, c] + excess * lobes[o, EXCESS + c]
                error = colours[o, c] - diffuse[v, c] - gloss * lobe
                spread = HIGHLIGHT_ERROR * gloss * lobe
                product *= _density(error, variances[o, c] + spread * spread, is_clipped[o, c])
            likelihoods[v] += trust[o] * math.log(product)
    log_prior = 0.0
    if has_excess:
        score = (math.log1p(excess) - EXCESS_MEAN) / EXCESS_SPREAD
        log_prior = -0.5 * EXCESS_WEIGHT * score * score
    return gloss, excess, log_prior


@compiled
def _equations(
    colours: NDArray[np.float32],
    is_clipped: NDArray[np.bool_],
    variances: NDArray[np.float32],
    lobes: NDArray[np.float32],
    trust: NDArray[np.float64],
    offsets: NDArray[np.int64],
    gloss: float,
    excess: float,
    diffuse: NDArray[np.float64],
    sums: NDArray[np.float64],
) -> tuple[tuple[float, float, float], tuple[float, float]]:
    """Gauss-Newton equations of steps in ``gloss`` and ``excess``, diffuse radiances eliminated.

    ``sums`` (V, 3, 4) takes the weights and, weighted, lobe, clipped lobe and colour. Returns the
    matrix (its 0 0, 0 1 and 1 1 elements) and the vector.
    """
    aa, ab, bb, ay, by = 0.0, 0.0, 0.0, 0.0, 0.0
    for v in range(len(diffuse)):
        for c in range(3):
            is_first = math.isnan(diffuse[v, c])
            mass, first, second, colour = 0.0, 0.0, 0.0, 0.0
            paa, pab, pbb, pay, pby = 0.0, 0.0, 0.0, 0.0, 0.0
            for o in range(offsets[v], offsets[v + 1]):
                clipped_lobe = lobes[o, EXCESS + c]
                lobe = lobes[o, c] + excess * clipped_lobe
                spread = HIGHLIGHT_ERROR * gloss * lobe
                variance = variances[o, c] + spread * spread
                rest = colours[o, c] - gloss * lobe
                error = 0.0 if is_first else rest - diffuse[v, c]
                weight = trust[o] * (FREEDOM + 1.0) / (FREEDOM * variance + error * error)
                if is_clipped[o, c] and error <= 0.0:
                    weight = 0.0
                other = gloss * clipped_lobe
                mass += weight
                first += weight * lobe
                second += weight * clipped_lobe
                colour += weight * colours[o, c]
                paa += weight * lobe * lobe
                pab += weight * lobe * other
                pbb += weight * other * other
                pay += weight * lobe * rest
                pby += weight * other * rest
            sums[v, c, 0], sums[v, c, 1] = mass, first - excess * second
            sums[v, c, 2], sums[v, c, 3] = second, colour
            if mass <= 0.0:
                continue
            level = (colour - gloss * first) / mass
            if level > 0.0:  # else the diffuse radiance is held at 0
                second *= gloss
                paa -= first * first / mass
                pab -= first * second / mass
                pbb -= second * second / mass
                pay -= first * level
                pby -= second * level
            aa, ab, bb, ay, by = aa + paa, ab + pab, bb + pbb, ay + pay, by + pby
    return (aa, ab, bb), (ay, by)


@compiled
def _stepped(
    matrix: tuple[float, float, float],
    vector: tuple[float, float],
    gloss: float,
    excess: float,
    has_excess: bool,
) -> tuple[float, float]:
    """``gloss`` and ``excess`` after one bounded step, with their priors."""
    aa, ab, bb = matrix
    ay, by = vector
    aa, ay = aa + 1.0, ay - gloss  # rho_s is about 0, with a deviation of 1
    moved = excess
    if has_excess:
        width = EXCESS_SPREAD * (1.0 + excess)
        prior = EXCESS_WEIGHT / (width * width)
        bb += prior
        by += prior * (1.0 + excess) * (EXCESS_MEAN - math.log1p(excess))
        determinant = aa * bb - ab * ab
        step = (bb * ay - ab * by) / determinant
        moved += (aa * by - ab * ay) / determinant
        moved = min(max(moved, 0.3 * excess), 3.0 * excess + 1.0)
    else:
        step = ay / aa
    return min(max(gloss + step, 0.1 * gloss, LEAST_GLOSS), 1.0), moved


@compiled
def _density(error: float, variance: float, is_bound: bool) -> float:
    """The Student-t density of an error.

    Of a lower bound it is the probability of anything brighter, in closed form for four degrees of
    freedom.
    """
    square = 1.0 + error * error / (variance * FREEDOM)
    if not is_bound:
        return MAXIMUM / (square * square * math.sqrt(square * variance))
    u = error / math.sqrt(variance * square)
    return max(0.5 - 0.375 * (u - u * u * u / 12.0), SMALLEST_TAIL)
