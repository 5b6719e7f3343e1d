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
from reflest_core.jit import compiled, fused

FREEDOM = 4.0
"""Degrees of freedom of the errors."""
ROUNDS, FURTHER_ROUNDS = 6, 3
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

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]
Slot = tuple[Array32, NDArray[np.bool_], Array32, Array]
"""Of one observation of each voxel: colours, whether these are bounds, variances and trust."""

_MASS, _FIRST, _COLOUR, _AA, _AY, _SECOND, _AB, _BB, _BY = range(9)
"""Weighted sums over a voxel's observations: of the weight, the lobe and the colour; of the lobe's
square and of its product with the rest; of the clipped lobe, and of the products of both slopes."""
_MOMENTS = 9


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


def fit_by_likelihood(
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
    has_excess = float(lobes[..., EXCESS:].max(initial=0.0)) > LEAST_CLIPPED
    laid_out = _lay_out(
        srgb.LINEAR[colours],
        colours == 255,
        colour_variances().astype(np.float32)[colours],
        trust,
        offsets,
        lobes,
        has_excess,
    )
    observed, grids = laid_out[:4], laid_out[4:]
    weights = observed[3]
    roughnesses, voxels = len(lobes), len(offsets) - 1
    diffuse, matte = np.zeros((roughnesses, 3, voxels)), np.zeros((3, voxels))
    # Their logarithms all at once, by vector instructions.
    densities = np.ones((roughnesses + 1, *weights.shape))
    fit_at_roughness(
        *observed, grids[0][0], grids[1][0], 0.0, 0.0, ROUNDS, True, matte, densities[-1]
    )
    least = LEAST_EXCESS if has_excess else 0.0
    start, rounds = (FIRST_GLOSS, math.expm1(EXCESS_MEAN) if has_excess else 0.0), ROUNDS
    found = np.zeros((roughnesses, 2))
    for k in range(roughnesses):
        if k > 0:
            diffuse[k] = diffuse[k - 1]
        found[k] = fit_at_roughness(
            *observed, grids[0][k], grids[1][k], *start, rounds, k == 0, diffuse[k], densities[k]
        )
        start, rounds = (found[k, 0], max(found[k, 1], least)), FURTHER_ROUNDS
    of_voxels = (weights * np.log(densities)).sum(axis=1)
    rho_s, excess = found.T
    log_prior = np.zeros(roughnesses)
    if has_excess:
        log_prior -= 0.5 * EXCESS_WEIGHT * ((np.log1p(excess) - EXCESS_MEAN) / EXCESS_SPREAD) ** 2
    return GlossFits(
        rho_s,
        excess,
        diffuse.transpose(0, 2, 1),
        of_voxels[:-1],
        log_prior,
        float(of_voxels[-1].sum()),
    )


@compiled
def _lay_out(
    colours: Array32,
    is_clipped: NDArray[np.bool_],
    variances: Array32,
    trust: Array,
    offsets: NDArray[np.int64],
    lobes: Array32,
    has_excess: bool,
) -> tuple[Array32, NDArray[np.bool_], Array32, Array, Array32, Array32]:
    """Lay observations out as slots of V voxels, whose vector instructions then run over voxels.

    Returns colours, channels at 255 and variances (3, S, V); trust (S, V), 0 where a voxel has
    fewer observations; lobes and clipped lobes (K, 3, S, V), which are 0 without an excess.
    """
    voxels, slots = len(offsets) - 1, 0
    for v in range(voxels):
        slots = max(slots, offsets[v + 1] - offsets[v])
    grid, weights = np.zeros((3, slots, voxels), np.float32), np.zeros((slots, voxels))
    bounds, noise = np.zeros(grid.shape, np.bool_), np.ones(grid.shape, np.float32)
    light = np.zeros((len(lobes), 3, slots, voxels), np.float32)
    clipped = np.zeros(light.shape, np.float32)
    for v in range(voxels):
        for slot in range(offsets[v + 1] - offsets[v]):
            o = offsets[v] + slot
            weights[slot, v] = trust[o]
            for c in range(3):
                grid[c, slot, v], noise[c, slot, v] = colours[o, c], variances[o, c]
                bounds[c, slot, v] = is_clipped[o, c]
                for k in range(len(lobes)):
                    light[k, c, slot, v] = lobes[k, o, c]
                    if has_excess:
                        clipped[k, c, slot, v] = lobes[k, o, EXCESS + c]
    return grid, bounds, noise, weights, light, clipped


@compiled
def fit_at_roughness(
    colours: Array32,
    is_clipped: NDArray[np.bool_],
    variances: Array32,
    trust: Array,
    lobes: Array32,
    clipped_lobes: Array32,
    gloss: float,
    excess: float,
    rounds: int,
    is_new: bool,
    diffuse: Array,
    densities: Array,
) -> tuple[float, float]:
    """Fit ``rho_s`` and the excess of clipped light at one roughness.

    Args:
        colours: (3, S, V) linear, of the observations in S slots of V voxels.
        is_clipped: (3, S, V) channels at 255.
        variances: (3, S, V) of the colours' noise.
        trust: (S, V) weight of each observation, the same for all roughnesses; 0 in empty slots.
        lobes: (3, S, V) radiance that is reflected at ``rho_s = 1``.
        clipped_lobes: (3, S, V) what clipped light adds to it for each unit above white.
        gloss: ``rho_s`` to begin with; 0 stays 0.
        excess: The same of the excess.
        rounds: Of reweighting.
        is_new: Whether the diffuse radiances are not known yet.
        diffuse: (3, V) diffuse radiances to begin with; takes those found.
        densities: (S, V) ones; takes the likelihood of each observation.

    Returns:
        ``rho_s`` and the excess.
    """
    is_matte, has_excess = gloss == 0.0, excess > 0.0
    _, slots, voxels = colours.shape
    sums, weights = np.zeros((3, _MOMENTS, voxels)), np.zeros(voxels)
    for turn in range(rounds):
        is_first = is_new and turn == 0
        sums[:] = 0.0
        matrix, vector = np.zeros(3), np.zeros(2)
        for c in range(3):
            for s in range(slots):
                of_slot = colours[c, s], is_clipped[c, s], variances[c, s], trust[s]
                lobe, clipped_lobe = lobes[c, s], clipped_lobes[c, s]
                _add_slot(
                    of_slot,
                    lobe,
                    clipped_lobe,
                    gloss,
                    excess,
                    diffuse[c],
                    is_first,
                    weights,
                    sums[c],
                )
                if has_excess:
                    _add_excess(colours[c, s], lobe, clipped_lobe, gloss, excess, weights, sums[c])
            _add_equations(sums[c], gloss, matrix, vector)
        old_excess = excess
        if not is_matte:
            gloss, excess = _stepped(matrix, vector, gloss, excess, has_excess)
        for c in range(3):
            _update_diffuse(sums[c], gloss, excess - old_excess, is_first, diffuse[c])
    for c in range(3):
        for s in range(slots):
            of_slot = colours[c, s], is_clipped[c, s], variances[c, s], trust[s]
            _multiply_densities(
                of_slot, lobes[c, s], clipped_lobes[c, s], gloss, excess, diffuse[c], densities[s]
            )
    return gloss, excess


@fused
def _add_slot(
    of_slot: Slot,
    lobes: Array32,
    clipped_lobes: Array32,
    gloss: float,
    excess: float,
    diffuse: Array,
    is_first: bool,
    weights: Array,
    sums: Array,
) -> None:
    """Weigh one observation of each voxel, and add it to the voxel's moments."""
    colours, is_clipped, variances, trust = of_slot
    for v in range(len(weights)):
        lobe = lobes[v] + excess * clipped_lobes[v]
        spread = HIGHLIGHT_ERROR * gloss * lobe
        variance = variances[v] + spread * spread
        rest = colours[v] - gloss * lobe
        error = 0.0 if is_first else rest - diffuse[v]
        weight = trust[v] * (FREEDOM + 1.0) / (FREEDOM * variance + error * error)
        weight = 0.0 if is_clipped[v] & (error <= 0.0) else weight
        weights[v] = weight
        sums[_MASS, v] += weight
        sums[_FIRST, v] += weight * lobe
        sums[_COLOUR, v] += weight * colours[v]
        sums[_AA, v] += weight * lobe * lobe
        sums[_AY, v] += weight * lobe * rest


@fused
def _add_excess(
    colours: Array32,
    lobes: Array32,
    clipped_lobes: Array32,
    gloss: float,
    excess: float,
    weights: Array,
    sums: Array,
) -> None:
    """Add what else the moments need where there is clipped light."""
    for v in range(len(weights)):
        lobe = lobes[v] + excess * clipped_lobes[v]
        rest, other = colours[v] - gloss * lobe, gloss * clipped_lobes[v]
        sums[_SECOND, v] += weights[v] * clipped_lobes[v]
        sums[_AB, v] += weights[v] * lobe * other
        sums[_BB, v] += weights[v] * other * other
        sums[_BY, v] += weights[v] * other * rest


@compiled
def _add_equations(sums: Array, gloss: float, matrix: Array, vector: Array) -> None:
    """Add Gauss-Newton equations of steps in ``gloss`` and ``excess``, diffuse ones eliminated.

    ``matrix`` are its elements 0 0, 0 1 and 1 1.
    """
    for v in range(sums.shape[1]):
        mass = sums[_MASS, v]
        if mass <= 0.0:
            continue
        aa, ab, bb = sums[_AA, v], sums[_AB, v], sums[_BB, v]
        ay, by = sums[_AY, v], sums[_BY, v]
        first, second = sums[_FIRST, v], gloss * sums[_SECOND, v]
        level = (sums[_COLOUR, v] - gloss * first) / mass
        if level > 0.0:  # else the diffuse radiance is held at 0
            aa -= first * first / mass
            ab -= first * second / mass
            bb -= second * second / mass
            ay -= first * level
            by -= second * level
        matrix[0] += aa
        matrix[1] += ab
        matrix[2] += bb
        vector[0] += ay
        vector[1] += by


@compiled
def _update_diffuse(
    sums: Array, gloss: float, more_excess: float, is_first: bool, diffuse: Array
) -> None:
    """Find each voxel's diffuse radiance, by the weights that it had in this turn."""
    for v in range(len(diffuse)):
        mass = sums[_MASS, v]
        if mass <= 0.0:  # all clipped and explained, or nothing counts
            diffuse[v] = WHITE if is_first else diffuse[v]
        else:
            lobe = sums[_FIRST, v] + more_excess * sums[_SECOND, v]
            diffuse[v] = max((sums[_COLOUR, v] - gloss * lobe) / mass, 0.0)


@compiled
def _stepped(
    matrix: Array, vector: Array, gloss: float, excess: float, has_excess: bool
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


@fused
def _multiply_densities(
    of_slot: Slot,
    lobes: Array32,
    clipped_lobes: Array32,
    gloss: float,
    excess: float,
    diffuse: Array,
    densities: Array,
) -> None:
    """Multiply in the Student-t density of one observation of each voxel, in one channel.

    Of a lower bound it is the probability of anything brighter, in closed form for four degrees of
    freedom.
    """
    colours, is_clipped, variances, _ = of_slot
    for v in range(len(densities)):
        lobe = lobes[v] + excess * clipped_lobes[v]
        error = colours[v] - diffuse[v] - gloss * lobe
        spread = HIGHLIGHT_ERROR * gloss * lobe
        variance = variances[v] + spread * spread
        square = 1.0 + error * error / (variance * FREEDOM)
        root = math.sqrt(square * variance)
        u = error / root
        tail = max(0.5 - 0.375 * (u - u * u * u / 12.0), SMALLEST_TAIL)
        densities[v] *= tail if is_clipped[v] else MAXIMUM / (square * square * root)
