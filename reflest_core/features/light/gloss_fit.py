# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Gloss from what changes with the view: whatever the diffuse light, seen lobes tell ``rho_s``.

Within a voxel, ``radiance = diffuse + rho_s * lobe(alpha)``, with one unknown diffuse radiance for
each voxel and channel. Where a lobe looks into light that was clipped or not seen, what is there
beyond white or beyond the smooth fill is unknown. Two more unknowns of the whole scene stand for
it, ``rho_s`` times either's mean, and an observation counts by how little of it its lobe sees.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.material_fit import likelihood
from reflest_core.features.light.nonnegative import nonnegative_minimum
from reflest_core.features.light.ward_lobe import ROUGHNESSES
from reflest_core.jit import compiled

ROUNDS = 5
RELATIVE, LEAST = 0.04, 0.005
"""Standard deviation of a radiance: share of itself, and in units of the sensor's white."""
PRIORS = (1.0, 0.01, 1.0)
"""Inverse variances, about 0, of ``rho_s`` and of what clipped and unseen light add."""
EVIDENCE = 0.15
"""Power of the misfit's inverse that makes a roughness likely, for each observation that counted.
It would be 3 (channels) for Gaussian errors of unknown size, but neighbours err alike."""
TRUST, CLIPPED = 3.0, 0.5
"""Power of a lobe's seen share by which its observation counts, and what of its clipped share is
taken for unseen."""


@dataclass(frozen=True)
class GlossFit:
    """K roughnesses, float32.

    ``gloss``: (K,), ``rho_s``. ``deviation``: (K,), its standard deviation. ``misfit``: (K,), root
    mean square error in units of what is expected, outliers weighing little. ``count``: (K,), of
    observations that counted.
    """

    gloss: NDArray[np.float32]
    deviation: NDArray[np.float32]
    misfit: NDArray[np.float32]
    count: NDArray[np.float32]

    @property
    def weight(self) -> NDArray[np.float32]:
        """(K,), how likely each roughness is by its misfit; they sum to 1."""
        return self.weight_by(EVIDENCE)

    def weight_by(self, evidence: float) -> NDArray[np.float32]:
        """The same, were this share of the observations to err each for itself."""
        return likelihood(self.misfit, evidence * float(self.count.max()))

    @property
    def roughness(self) -> int:
        """Index of the roughness that is nearest to the mean of all, by their weights."""
        mean = self.weight @ np.array(ROUGHNESSES)
        return int(np.abs(np.array(ROUGHNESSES) - mean).argmin())


def fit_gloss(
    colours: NDArray[np.float32],
    clipped: NDArray[np.bool_],
    lobes: NDArray[np.float32],
    voxel_of: NDArray[np.int64],
) -> GlossFit:
    """``colours``, ``clipped``: (O, 3), linear. ``lobes``: (O, K, 5). ``voxel_of``: (O,) rising."""
    voxels = int(voxel_of[-1]) + 1 if len(voxel_of) else 0
    return GlossFit(*_fit(colours, clipped, lobes, voxel_of, voxels))


@compiled
def _fit(
    colours: NDArray[np.float32],
    clipped: NDArray[np.bool_],
    lobes: NDArray[np.float32],
    voxel_of: NDArray[np.int64],
    voxels: int,
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    count, roughnesses = lobes.shape[:2]
    fits = np.zeros((4, roughnesses), np.float32)
    trust, weight = np.zeros(count), np.zeros((count, 3))
    diffuse, x = np.zeros((voxels, 3)), np.zeros(3)
    sums = np.zeros((voxels, 3, 5))  # of weights, and weighted of the three answers and the colour
    for k in range(roughnesses):
        for o in range(count):
            trust[o] = max(lobes[o, k, 3] - CLIPPED * lobes[o, k, 4], 0.0) ** TRUST
        found, matrix = np.zeros(3), np.zeros((3, 3))
        for turn in range(ROUNDS):
            sums[:] = 0.0
            for o in range(count):
                v = voxel_of[o]
                for c in range(3):
                    weight[o, c] = 0.0
                    if clipped[o, c] or trust[o] == 0.0:
                        continue
                    y = float(colours[o, c])
                    _answers(lobes[o, k], c, x)
                    scale = RELATIVE * y + LEAST
                    w = trust[o] / (scale * scale)
                    if turn > 0:
                        error = (y - diffuse[v, c] - _sum(found, x)) / scale
                        w /= 1.0 + error * error
                    weight[o, c] = w
                    sums[v, c, 0] += w
                    for i in range(3):
                        sums[v, c, 1 + i] += w * x[i]
                    sums[v, c, 4] += w * y
            matrix[:], vector = 0.0, np.zeros(3)
            for i in range(3):
                matrix[i, i] = PRIORS[i]
            for o in range(count):
                v = voxel_of[o]
                for c in range(3):
                    w = weight[o, c]
                    if w == 0.0:
                        continue
                    _answers(lobes[o, k], c, x)
                    for i in range(3):
                        x[i] -= sums[v, c, 1 + i] / sums[v, c, 0]
                    for i in range(3):
                        vector[i] += w * x[i] * colours[o, c]
                        for j in range(3):
                            matrix[i, j] += w * x[i] * x[j]
            found = nonnegative_minimum(matrix, vector, found)
            found[0] = min(found[0], 1.0)
            for v in range(voxels):
                for c in range(3):
                    if sums[v, c, 0] > 0.0:
                        rest = sums[v, c, 4] - _sum(found, sums[v, c, 1:4])
                        diffuse[v, c] = max(rest / sums[v, c, 0], 0.0)
        total, squares = 1e-9, 0.0
        for o in range(count):
            for c in range(3):
                if weight[o, c] > 0.0:
                    y = float(colours[o, c])
                    _answers(lobes[o, k], c, x)
                    error = y - diffuse[voxel_of[o], c] - _sum(found, x)
                    total += trust[o]
                    squares += trust[o] * np.log1p((error / (RELATIVE * y + LEAST)) ** 2)
        fits[0, k] = found[0]
        fits[1, k] = _first_deviation(matrix)
        fits[2, k] = np.sqrt(squares / total)
        fits[3, k] = total / 3.0
    return fits[0], fits[1], fits[2], fits[3]


@compiled
def _answers(lobe: NDArray[np.float32], channel: int, x: NDArray[np.float64]) -> None:
    """Write what a lobe (5,) reflects at ``rho_s = 1`` into ``x`` (3,).

    Of the light as it is known, of clipped light for each unit above white, and of unseen light for
    each unit above its fill.
    """
    x[0], x[1], x[2] = lobe[channel], lobe[4], 1.0 - lobe[3]


@compiled
def _sum(factors: NDArray[np.float64], x: NDArray[np.float64]) -> float:
    return float(factors[0] * x[0] + factors[1] * x[1] + factors[2] * x[2])


@compiled
def _first_deviation(m: NDArray[np.float64]) -> float:
    """The first unknown's standard deviation, from the matrix (3, 3) of the normal equations."""
    corner = m[1, 1] * m[2, 2] - m[1, 2] * m[1, 2]
    rest = m[0, 1] * (m[0, 1] * m[2, 2] - m[1, 2] * m[0, 2])
    rest -= m[0, 2] * (m[0, 1] * m[1, 2] - m[1, 1] * m[0, 2])
    return float(np.sqrt(corner / (m[0, 0] * corner - rest)))
