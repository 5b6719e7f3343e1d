# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Gloss from what changes with the view: whatever the diffuse light, seen lobes tell ``rho_s``.

Within a voxel, ``radiance = diffuse + rho_s * lobe(alpha)``, with one unknown diffuse radiance for
each voxel and channel. Only observations count whose lobe looks into light that was seen and was
not clipped; there, no unseen light takes part.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.material_fit import likelihood
from reflest_core.features.light.ward_lobe import ROUGHNESSES
from reflest_core.jit import compiled

ROUNDS = 4
RELATIVE, LEAST = 0.07, 0.01
"""Standard deviation of a radiance: share of itself, and in units of the sensor's white."""
PRIOR = 4.0
"""Inverse variance of ``rho_s`` about 0."""
SHARPNESS = 20.0
"""How fast a roughness loses weight as its misfit grows: the power of the misfit's inverse."""
TRUST = 4.0
"""Power of a lobe's seen and unclipped share by which its observation counts."""


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
        return likelihood(self.misfit, SHARPNESS)

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
    found = np.zeros((4, roughnesses), np.float32)
    weight = np.zeros((count, 3))
    trust = np.zeros(count)
    diffuse = np.zeros((voxels, 3))
    sums = np.zeros((voxels, 3, 3))
    for k in range(roughnesses):
        rho_s, xx = 0.0, 0.0
        for o in range(count):
            trust[o] = max(lobes[o, k, 3] - lobes[o, k, 4], 0.0) ** TRUST
        for turn in range(ROUNDS):
            sums[:] = 0.0
            for o in range(count):
                v = voxel_of[o]
                for c in range(3):
                    y, x = float(colours[o, c]), float(lobes[o, k, c])
                    weight[o, c] = 0.0
                    if clipped[o, c] or trust[o] == 0.0:
                        continue
                    scale = RELATIVE * y + LEAST
                    w = trust[o] / (scale * scale)
                    if turn > 0:
                        error = (y - diffuse[v, c] - rho_s * x) / scale
                        w /= 1.0 + error * error
                    weight[o, c] = w
                    sums[v, c, 0] += w
                    sums[v, c, 1] += w * x
                    sums[v, c, 2] += w * y
            xx, xy = 0.0, 0.0
            for o in range(count):
                v = voxel_of[o]
                for c in range(3):
                    w = weight[o, c]
                    if w > 0.0:
                        dx = lobes[o, k, c] - sums[v, c, 1] / sums[v, c, 0]
                        xx += w * dx * dx
                        xy += w * dx * colours[o, c]
            rho_s = min(max(xy / (xx + PRIOR), 0.0), 1.0)
            for v in range(voxels):
                for c in range(3):
                    if sums[v, c, 0] > 0.0:
                        diffuse[v, c] = max(
                            (sums[v, c, 2] - rho_s * sums[v, c, 1]) / sums[v, c, 0], 0.0
                        )
        total, squares = 1e-9, 0.0
        for o in range(count):
            v = voxel_of[o]
            for c in range(3):
                if weight[o, c] > 0.0:
                    y = float(colours[o, c])
                    error = (y - diffuse[v, c] - rho_s * lobes[o, k, c]) / (RELATIVE * y + LEAST)
                    total += trust[o]
                    squares += trust[o] * np.log1p(error * error)
        found[0, k] = rho_s
        found[1, k] = 1.0 / np.sqrt(xx + PRIOR)
        found[2, k] = np.sqrt(squares / total)
        found[3, k] = total / 3.0
    return found[0], found[1], found[2], found[3]
