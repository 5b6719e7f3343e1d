# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The least squares of :mod:`.gloss_fit`, for several roughnesses at once.

Where a lobe looks into light that was clipped or not seen, what is there beyond white or beyond the
smooth fill is unknown. So of the whole scene there are three unknowns: ``rho_s``, and ``rho_s``
times the mean of either. An observation counts the less the more of it its lobe sees. A clipped one
is a lower bound: it counts where the model is darker.

The roughnesses have a vector instruction's lanes each, so that one pass over the observations in
each round does for all of them.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.nonnegative import nonnegative_minimum
from reflest_core.jit import compiled, fused

ROUNDS = 4
RELATIVE, LEAST = 0.04, 0.005
"""Standard deviation of a radiance: share of itself, and in units of the sensor's white."""
COARSE = 0.15
"""The same of what a lobe reflects, as a share of it: texels and half vectors are few, and beside a
lamp that is a hundred times brighter than white much depends on them."""
FIRST_GLOSS = 0.5
"""``rho_s`` by which that is judged before it is known."""
PRIORS = (1.0, 0.01, 1.0)
"""Inverse variances, about 0, of ``rho_s`` and of what clipped and unseen light add."""
CLIPPED = 0.5
"""What of a lobe's clipped share is taken for unseen; an observation counts by the cube of its
lobe's seen share."""
ROUGHNESSES_AT_ONCE = 8
LANES = 3 * ROUGHNESSES_AT_ONCE
"""Of a vector operation: the roughnesses in each channel."""

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

_TRUST, _LOBE, _CLIPPED, _UNSEEN, _COLOUR, _NOISE, _IS_BOUND = range(7)
"""Rows of what is known of an observation: how much it counts; what it reflects at ``rho_s = 1`` of
the light as it is known, of clipped light for each unit above white, and of unseen light for each
unit above its fill; its colour, the variance of that, and 1 where it is clipped."""
_ROWS = 7
_GLOSS = 3
"""Row after those of the three unknowns: ``rho_s`` by which the lobe's own errors are judged."""


@compiled
def fit_roughnesses(
    colours: NDArray[np.float32],
    clipped: NDArray[np.bool_],
    lobes: NDArray[np.float32],
    voxel_of: NDArray[np.int64],
    voxels: int,
) -> Array:
    """Fit ``rho_s`` at each roughness by IRLS.

    Args:
        colours: (O, 3) linear.
        clipped: (O, 3) True where a channel is saturated.
        lobes: (O, K, 5) of :func:`~.ward_lobe.lobe_radiance`; K at most
            :data:`ROUGHNESSES_AT_ONCE`.
        voxel_of: (O,) rising.
        voxels: number of voxels.

    Returns:
        (K, 4): ``rho_s``, its standard deviation, the misfit and how many observations counted.
    """
    roughnesses = lobes.shape[1]
    known = _known(colours, clipped, lobes)
    starts = np.searchsorted(voxel_of, np.arange(voxels + 1))
    counts = np.zeros(len(known), np.bool_)
    for o in range(len(known)):
        counts[o] = known[o, :LANES].any()
    # Flat arrays of rows of lanes: the compiler knows their distances, and so can use vectors.
    unknowns = np.zeros((_GLOSS + 1) * LANES, np.float32)
    unknowns[_GLOSS * LANES :] = FIRST_GLOSS
    before = np.zeros_like(unknowns)
    diffuse = np.ones((voxels, LANES), np.float32)
    diffuse_before = np.ones_like(diffuse)
    sums, moments = np.zeros((voxels, 5 * LANES), np.float32), np.zeros(14 * LANES, np.float32)
    equations = np.zeros(9 * LANES)
    matrix, vector = np.zeros((3, 3)), np.zeros(3)
    fits = np.zeros((roughnesses, 4))
    for turn in range(ROUNDS):
        before[:], diffuse_before[:] = unknowns, diffuse
        equations[:] = 0.0
        for v in range(voxels):
            moments[:] = 0.0
            for o in range(starts[v], starts[v + 1]):
                if counts[o]:
                    _add_observation(known[o], turn == 0, before, diffuse[v], moments)
            _add_voxel(moments, sums[v], equations)
        for k in range(roughnesses):
            _read_equations(equations, k, matrix, vector)
            start = before[k : 3 * LANES : LANES].astype(np.float64)
            found = nonnegative_minimum(matrix, vector, start)
            found[0] = min(found[0], 1.0)
            for lane in range(k, LANES, ROUGHNESSES_AT_ONCE):
                unknowns[_GLOSS * LANES + lane] = found[0]
                for i in range(3):
                    unknowns[i * LANES + lane] = found[i]
            fits[k, 0], fits[k, 1] = found[0], _first_deviation(matrix)
        for v in range(voxels):
            _update_diffuse(sums[v], unknowns, diffuse[v])
    for k in range(roughnesses):
        total, squares = 1e-9, 0.0
        for v in range(voxels):
            for o in range(starts[v], starts[v + 1]):
                trust, excess = known[o, k], 1.0
                if trust == 0.0:
                    continue
                for lane in range(k, LANES, ROUGHNESSES_AT_ONCE):
                    is_bound = known[o, _IS_BOUND * LANES + lane] > 0.0
                    if is_bound and _error(known[o], lane, before, diffuse_before[v]) <= 0.0:
                        continue
                    error = _error(known[o], lane, unknowns, diffuse[v])
                    spread = COARSE * unknowns[lane] * known[o, _LOBE * LANES + lane]
                    variance = known[o, _NOISE * LANES + lane] + spread * spread
                    excess *= 1.0 + error * error / variance
                    total += trust
                squares += trust * math.log(excess)
        fits[k, 2], fits[k, 3] = math.sqrt(squares / total), total / 3.0
    return fits


@compiled
def _known(
    colours: NDArray[np.float32], clipped: NDArray[np.bool_], lobes: NDArray[np.float32]
) -> NDArray[np.float32]:
    """(O, 7 * LANES) the rows that are named above; lanes without a roughness have no trust."""
    known = np.zeros((len(lobes), _ROWS * LANES), np.float32)
    for o in range(len(lobes)):
        for k in range(ROUGHNESSES_AT_ONCE):
            for c in range(3):
                lane = c * ROUGHNESSES_AT_ONCE + k
                known[o, _COLOUR * LANES + lane] = colours[o, c]
                known[o, _NOISE * LANES + lane] = (RELATIVE * colours[o, c] + LEAST) ** 2
                known[o, _IS_BOUND * LANES + lane] = clipped[o, c]
                if k < lobes.shape[1]:
                    seen = max(lobes[o, k, 3] - CLIPPED * lobes[o, k, 4], 0.0)
                    known[o, _TRUST * LANES + lane] = seen * seen * seen
                    known[o, _LOBE * LANES + lane] = lobes[o, k, c]
                    known[o, _CLIPPED * LANES + lane] = lobes[o, k, 4]
                    known[o, _UNSEEN * LANES + lane] = 1.0 - lobes[o, k, 3]
    return known


@fused
def _add_observation(
    known: Array32, is_first: bool, unknowns: Array32, diffuse: Array32, moments: Array32
) -> None:
    """Add an observation to its voxel's weighted ``moments``, rows of lanes.

    Those are the weight; weighted, the three answers and the colour; the answers' products with one
    another, row by row; their products with the colour.
    """
    zero, coarse = np.float32(0.0), np.float32(COARSE)
    for n in range(LANES):
        x, y, z = known[_LOBE * LANES + n], known[_CLIPPED * LANES + n], known[_UNSEEN * LANES + n]
        colour = known[_COLOUR * LANES + n]
        error = colour - diffuse[n] - unknowns[n] * x
        error -= unknowns[LANES + n] * y + unknowns[2 * LANES + n] * z
        spread = coarse * unknowns[_GLOSS * LANES + n] * x
        variance = known[_NOISE * LANES + n] + spread * spread
        variance += zero if is_first else error * error
        is_met = (known[_IS_BOUND * LANES + n] > zero) & (is_first | (error <= zero))
        weight = zero if is_met else known[_TRUST * LANES + n] / variance
        of_x, of_y, of_z = weight * x, weight * y, weight * z
        moments[n] += weight
        moments[LANES + n] += of_x
        moments[2 * LANES + n] += of_y
        moments[3 * LANES + n] += of_z
        moments[4 * LANES + n] += weight * colour
        moments[5 * LANES + n] += of_x * x
        moments[6 * LANES + n] += of_x * y
        moments[7 * LANES + n] += of_x * z
        moments[8 * LANES + n] += of_y * y
        moments[9 * LANES + n] += of_y * z
        moments[10 * LANES + n] += of_z * z
        moments[11 * LANES + n] += of_x * colour
        moments[12 * LANES + n] += of_y * colour
        moments[13 * LANES + n] += of_z * colour


@fused
def _add_voxel(moments: Array32, sums: Array32, equations: Array) -> None:
    """Add a voxel to the normal equations, each answer taken from its mean in voxel and channel.

    ``sums`` takes the first five rows of the moments; ``equations`` are six rows of the matrix'
    upper triangle and three of the vector.
    """
    for n in range(LANES):
        weight, x = float(moments[n]), float(moments[LANES + n])
        y, z = float(moments[2 * LANES + n]), float(moments[3 * LANES + n])
        colour = float(moments[4 * LANES + n])
        inverse = 1.0 / weight if weight > 0.0 else 0.0
        equations[n] += moments[5 * LANES + n] - x * x * inverse
        equations[LANES + n] += moments[6 * LANES + n] - x * y * inverse
        equations[2 * LANES + n] += moments[7 * LANES + n] - x * z * inverse
        equations[3 * LANES + n] += moments[8 * LANES + n] - y * y * inverse
        equations[4 * LANES + n] += moments[9 * LANES + n] - y * z * inverse
        equations[5 * LANES + n] += moments[10 * LANES + n] - z * z * inverse
        equations[6 * LANES + n] += moments[11 * LANES + n] - x * colour * inverse
        equations[7 * LANES + n] += moments[12 * LANES + n] - y * colour * inverse
        equations[8 * LANES + n] += moments[13 * LANES + n] - z * colour * inverse
    sums[:] = moments[: 5 * LANES]


@compiled
def _read_equations(equations: Array, k: int, matrix: Array, vector: Array) -> None:
    """Fill in ``matrix`` (3, 3), priors included, and ``vector`` (3,) of one roughness."""
    row = 0
    for i in range(3):
        vector[i] = _sum_of_channels(equations, 6 + i, k)
        for j in range(i, 3):
            matrix[i, j] = matrix[j, i] = _sum_of_channels(equations, row, k)
            row += 1
        matrix[i, i] += PRIORS[i]


@compiled
def _sum_of_channels(rows: Array, row: int, k: int) -> float:
    total = 0.0
    for lane in range(k, LANES, ROUGHNESSES_AT_ONCE):
        total += rows[row * LANES + lane]
    return total


@fused
def _update_diffuse(sums: Array32, unknowns: Array32, diffuse: Array32) -> None:
    """What a voxel sends in each channel beside its reflections, where something counts."""
    for n in range(LANES):
        weight = float(sums[n])
        rest = float(sums[4 * LANES + n]) - unknowns[n] * sums[LANES + n]
        rest -= unknowns[LANES + n] * sums[2 * LANES + n]
        rest -= unknowns[2 * LANES + n] * sums[3 * LANES + n]
        mean = max(rest / (weight if weight > 0.0 else 1.0), 0.0)
        diffuse[n] = mean if weight > 0.0 else diffuse[n]


@compiled
def _error(known: Array32, lane: int, unknowns: Array32, diffuse: Array32) -> float:
    """Of a channel of an observation, at one roughness."""
    rest = known[_COLOUR * LANES + lane] - diffuse[lane]
    for i in range(3):
        rest -= unknowns[i * LANES + lane] * known[(_LOBE + i) * LANES + lane]
    return float(rest)


@compiled
def _first_deviation(m: NDArray[np.float64]) -> float:
    """The first unknown's standard deviation, from the matrix (3, 3) of the normal equations."""
    corner = m[1, 1] * m[2, 2] - m[1, 2] * m[1, 2]
    rest = m[0, 1] * (m[0, 1] * m[2, 2] - m[1, 2] * m[0, 2])
    rest -= m[0, 2] * (m[0, 1] * m[1, 2] - m[1, 1] * m[0, 2])
    return float(np.sqrt(corner / (m[0, 0] * corner - rest)))
