# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The least squares of :mod:`.gloss_fit`, for one roughness.

Where a lobe looks into light that was clipped or not seen, what is there beyond white or beyond the
smooth fill is unknown. So of the whole scene there are three unknowns: ``rho_s``, and ``rho_s``
times the mean of either. An observation counts the less the more of it its lobe sees. A clipped one
is a lower bound: it counts where the model is darker.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.nonnegative import nonnegative_minimum
from reflest_core.jit import compiled

ROUNDS = 6
RELATIVE, LEAST = 0.04, 0.005
"""Standard deviation of a radiance: share of itself, and in units of the sensor's white."""
COARSE = 0.15
"""The same of what a lobe reflects, as a share of it: texels and half vectors are few, and beside a
lamp that is a hundred times brighter than white much depends on them."""
FIRST_GLOSS = 0.5
"""``rho_s`` by which that is judged before it is known."""
PRIORS = (1.0, 0.01, 1.0)
"""Inverse variances, about 0, of ``rho_s`` and of what clipped and unseen light add."""
TRUST, CLIPPED = 3.0, 0.5
"""Power of a lobe's seen share by which its observation counts, and what of its clipped share is
taken for unseen."""

Array = NDArray[np.float64]


@compiled
def fit_roughness(
    colours: NDArray[np.float32],
    clipped: NDArray[np.bool_],
    lobes: NDArray[np.float32],
    roughness: int,
    voxel_of: NDArray[np.int64],
    voxels: int,
) -> tuple[float, float, float, float]:
    """Fit ``rho_s`` at one roughness by IRLS.

    Args:
        colours: (O, 3) linear.
        clipped: (O, 3) True where a channel is saturated.
        lobes: (O, K, 5) of :func:`~.ward_lobe.lobe_radiance`.
        roughness: index of the roughness.
        voxel_of: (O,) rising.
        voxels: number of voxels.

    Returns:
        ``rho_s``, its standard deviation, the misfit and how many observations counted.
    """
    trust = np.zeros(len(colours))
    for o in range(len(colours)):
        seen = lobes[o, roughness, 3] - CLIPPED * lobes[o, roughness, 4]
        trust[o] = max(seen, 0.0) ** TRUST
    answers = _answers(lobes, roughness)
    weight = np.zeros((len(colours), 3))
    diffuse, found, matrix = np.ones((voxels, 3)), np.zeros(3), np.zeros((3, 3))
    for turn in range(ROUNDS):
        gloss = found[0] if turn > 0 else FIRST_GLOSS
        for o in range(len(colours)):
            if trust[o] == 0.0:
                continue
            for c in range(3):
                error = colours[o, c] - diffuse[voxel_of[o], c] - _reflected(found, answers, o, c)
                variance = _variance(colours[o, c], gloss * answers[o, c, 0])
                if clipped[o, c] and (turn == 0 or error <= 0.0):
                    weight[o, c] = 0.0
                else:
                    doubt = error * error if turn > 0 else 0.0
                    weight[o, c] = trust[o] / (variance + doubt)
        sums = _sums(colours, answers, weight, voxel_of, voxels)
        matrix, vector = _normal_equations(colours, answers, weight, voxel_of, sums)
        found = nonnegative_minimum(matrix, vector, found)
        found[0] = min(found[0], 1.0)
        _rest(sums, found, diffuse)
    total, squares = 1e-9, 0.0
    for o in range(len(colours)):
        for c in range(3):
            if weight[o, c] > 0.0:
                error = colours[o, c] - diffuse[voxel_of[o], c] - _reflected(found, answers, o, c)
                total += trust[o]
                variance = _variance(colours[o, c], found[0] * answers[o, c, 0])
                squares += trust[o] * np.log1p(error * error / variance)
    return found[0], _first_deviation(matrix), np.sqrt(squares / total), total / 3.0


@compiled
def _rest(sums: Array, found: Array, diffuse: Array) -> None:
    """What voxels send beside their reflections, into ``diffuse`` (V, 3) where something counts."""
    for v in range(len(diffuse)):
        for c in range(3):
            if sums[v, c, 0] > 0.0:
                rest = sums[v, c, 4]
                for i in range(3):
                    rest -= found[i] * sums[v, c, 1 + i]
                diffuse[v, c] = max(rest / sums[v, c, 0], 0.0)


@compiled
def _variance(colour: float, reflected: float) -> float:
    """Of a colour of which the lobe is thought to have ``reflected`` so much."""
    return float((RELATIVE * colour + LEAST) ** 2 + (COARSE * reflected) ** 2)


@compiled
def _answers(lobes: NDArray[np.float32], roughness: int) -> Array:
    """(O, 3, 3): what lobes reflect in each channel at ``rho_s = 1``.

    Of the light as it is known, of clipped light for each unit above white, and of unseen light for
    each unit above its fill.
    """
    answers = np.empty((len(lobes), 3, 3))
    for o in range(len(lobes)):
        for c in range(3):
            answers[o, c, 0] = lobes[o, roughness, c]
            answers[o, c, 1] = lobes[o, roughness, 4]
            answers[o, c, 2] = 1.0 - lobes[o, roughness, 3]
    return answers


@compiled
def _reflected(found: Array, answers: Array, o: int, c: int) -> float:
    """What the three unknowns make of an observation, beside its diffuse radiance."""
    total = 0.0
    for i in range(3):
        total += found[i] * answers[o, c, i]
    return total


@compiled
def _sums(
    colours: NDArray[np.float32],
    answers: Array,
    weight: Array,
    voxel_of: NDArray[np.int64],
    voxels: int,
) -> Array:
    """(V, 3, 5) of voxels and channels: weights, and weighted the three answers and the colour."""
    sums = np.zeros((voxels, 3, 5))
    for o in range(len(colours)):
        for c in range(3):
            if weight[o, c] == 0.0:
                continue
            place = sums[voxel_of[o], c]
            place[0] += weight[o, c]
            for i in range(3):
                place[1 + i] += weight[o, c] * answers[o, c, i]
            place[4] += weight[o, c] * colours[o, c]
    return sums


@compiled
def _normal_equations(
    colours: NDArray[np.float32],
    answers: Array,
    weight: Array,
    voxel_of: NDArray[np.int64],
    sums: Array,
) -> tuple[Array, Array]:
    """Matrix (3, 3) and vector (3,), each answer taken from its mean in its voxel and channel."""
    matrix, vector, x = np.zeros((3, 3)), np.zeros(3), np.zeros(3)
    for i in range(3):
        matrix[i, i] = PRIORS[i]
    for o in range(len(colours)):
        for c in range(3):
            w = weight[o, c]
            if w == 0.0:
                continue
            for i in range(3):
                mean = sums[voxel_of[o], c, 1 + i] / sums[voxel_of[o], c, 0]
                x[i] = answers[o, c, i] - mean
            for i in range(3):
                vector[i] += w * x[i] * colours[o, c]
                for j in range(3):
                    matrix[i, j] += w * x[i] * x[j]
    return matrix, vector


@compiled
def _first_deviation(m: NDArray[np.float64]) -> float:
    """The first unknown's standard deviation, from the matrix (3, 3) of the normal equations."""
    corner = m[1, 1] * m[2, 2] - m[1, 2] * m[1, 2]
    rest = m[0, 1] * (m[0, 1] * m[2, 2] - m[1, 2] * m[0, 2])
    rest -= m[0, 2] * (m[0, 1] * m[1, 2] - m[1, 1] * m[0, 2])
    return float(np.sqrt(corner / (m[0, 0] * corner - rest)))
