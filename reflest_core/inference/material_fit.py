# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One material for the whole surface: for every roughness, the best ``rho_d`` and ``rho_s``.

With the true light and roughness, ``apparent = rho_d + rho_s * lobe(alpha)`` for every observation
and channel. Unlike in lightnet's :mod:`.lobe_fit`, ``rho_s`` is the same for the three channels,
comparisons run across voxels too, and outliers (occluded light, highlights of unseen lamps) lose
their weight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import fused

ROUNDS = 4
"""Of reweighting."""
RELATIVE, LEAST = 0.15, 0.03
"""Of an observation's error, in apparent albedo: share of the model's value, and at any value."""
FIRST_GLOSS = 1.0
"""``rho_s`` by which that is judged before it is known: the greatest, so that no highlight that is
wrongly expected decides."""
PRIOR = 1.0
"""Inverse variance of ``rho_s`` about 0: with hardly any evidence there is no gloss."""
SHARPNESS = 40.0
"""How fast a roughness loses weight as its misfit grows: the power of the misfit's inverse."""


@dataclass(frozen=True)
class MaterialFit:
    """The fit at each of K roughnesses, float32.

    Attributes:
        albedo: (K, 3) ``rho_d``.
        gloss: (K,) ``rho_s``.
        misfit: (K,) root mean square error in units of what is expected, outliers weighing little.
        weight: (K,) how likely each roughness is by its misfit; they sum to 1.
    """

    albedo: NDArray[np.float32]
    gloss: NDArray[np.float32]
    misfit: NDArray[np.float32]
    weight: NDArray[np.float32]


def fit_material(
    apparent: NDArray[np.float32], lobe: NDArray[np.float32], weight: NDArray[np.float32]
) -> MaterialFit:
    """Fit ``rho_d`` and ``rho_s`` at each of K roughnesses by IRLS.

    Args:
        apparent: (O, 3) linear colour over diffuse light ``E(n) / pi``.
        lobe: (O, K, 3) reflected radiance at ``rho_s = 1`` over diffuse light.
        weight: (O, 3) of each observation, 0 where saturated.
    """
    albedo, gloss, misfit = _fit(apparent, lobe, weight)
    return MaterialFit(albedo, gloss, misfit, likelihood(misfit, SHARPNESS))


def likelihood(misfit: NDArray[np.float32], sharpness: float) -> NDArray[np.float32]:
    """Weigh roughnesses by their misfits.

    Args:
        misfit: (K,) in units of what is expected.
        sharpness: power of the misfit's inverse.

    Returns:
        (K,) float32, summing to 1.
    """
    known = np.maximum(misfit, np.float32(1e-3))
    likely = (known / known.min()) ** -sharpness
    return np.asarray(likely / likely.sum(), np.float32)


@fused
def _fit(
    apparent: NDArray[np.float32], lobe: NDArray[np.float32], weight: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    count, roughnesses = lobe.shape[:2]
    albedo = np.zeros((roughnesses, 3), np.float32)
    gloss = np.zeros(roughnesses, np.float32)
    misfit = np.zeros(roughnesses, np.float32)
    for k in range(roughnesses):
        rho_d = np.zeros(3)
        rho_s = 0.0
        for turn in range(ROUNDS):
            xy, xx = 0.0, 0.0
            mean_x, mean_y, mass = np.zeros(3), np.zeros(3), np.zeros(3)
            for c in range(3):
                sx, sy, sxx, sxy, s = 0.0, 0.0, 0.0, 0.0, 1e-9
                for o in range(count):
                    if weight[o, c] <= 0.0:
                        continue
                    x, y = float(lobe[o, k, c]), float(apparent[o, c])
                    if turn == 0:
                        scale = RELATIVE * (y + FIRST_GLOSS * x) + LEAST
                        w = weight[o, c] / (scale * scale)
                    else:
                        model = rho_d[c] + rho_s * x
                        scale = RELATIVE * model + LEAST
                        error = (y - model) / scale
                        w = weight[o, c] / (scale * scale * (1.0 + error * error))
                    sx += w * x
                    sy += w * y
                    sxx += w * x * x
                    sxy += w * x * y
                    s += w
                mean_x[c], mean_y[c], mass[c] = sx / s, sy / s, s
                xx += sxx - sx * sx / s
                xy += sxy - sx * sy / s
            rho_s = min(max(xy / (xx + PRIOR), 0.0), 1.0)
            for c in range(3):
                rho_d[c] = min(max(mean_y[c] - rho_s * mean_x[c], 0.0), 2.0)
        total, squares = 1e-9, 0.0
        for o in range(count):
            for c in range(3):
                model = rho_d[c] + rho_s * lobe[o, k, c]
                error = (apparent[o, c] - model) / (RELATIVE * model + LEAST)
                total += weight[o, c]
                squares += weight[o, c] * np.log1p(error * error)
        albedo[k] = rho_d
        gloss[k] = rho_s
        misfit[k] = np.sqrt(squares / total)
    return albedo, gloss, misfit
