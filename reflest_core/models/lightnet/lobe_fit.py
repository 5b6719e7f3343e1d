# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How well each roughness explains the observations: least squares over one voxel and over all.

With the true light and roughness, ``apparent = rho_d + rho_s * lobe(alpha)`` in every channel; so
the slope over observations is ``rho_s``, the intercept ``rho_d``, and the share of the variance
that is explained is greatest at the true ``alpha``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LIMITS = (-0.5, 2.0)
"""Bounds of slopes and intercepts; beyond them a fit has failed."""
PRIOR_VARIANCE = 1e-4
"""Added to the variance of a lobe: a lobe that hardly varies has slope 0."""


@dataclass(frozen=True)
class LobeFit:
    """Fits by channel and roughness.

    The last axis holds slope, intercept and explained share of the variance in [0, 1].

    Attributes:
        voxels: (V, 3, K, 3) float32, of each voxel.
        scene: (3, K, 3) float32, of all voxels.
    """

    voxels: NDArray[np.float32]
    scene: NDArray[np.float32]


def fit_lobes(
    apparent: NDArray[np.float32],
    lobe: NDArray[np.float32],
    weight: NDArray[np.float32],
    voxel_weight: NDArray[np.float32],
) -> LobeFit:
    """Fit observations as lines over each roughness's lobe, by least squares.

    Args:
        apparent: (V, O, 3), observations over diffuse light.
        lobe: (V, O, K, 3), the lobe of each roughness over diffuse light.
        weight: (V, O, 3) of each observation, 0 where there is none or where it is clipped.
        voxel_weight: (V,) of each voxel in the scene's fit, whose slope is that within voxels.
    """
    y = apparent.transpose(0, 2, 1)[:, :, None].astype(np.float64)
    x = lobe.transpose(0, 3, 2, 1).astype(np.float64)
    w = weight.transpose(0, 2, 1)[:, :, None].astype(np.float64)
    total = w.sum(axis=-1)
    norm = np.maximum(total, 1e-9)
    mean_x, mean_y = (w * x).sum(axis=-1) / norm, (w * y).sum(axis=-1) / norm
    dx, dy = x - mean_x[..., None], y - mean_y[..., None]
    xx, xy = (w * dx * dx).sum(axis=-1), (w * dx * dy).sum(axis=-1)
    yy = np.broadcast_to((w * dy * dy).sum(axis=-1), xx.shape)
    voxels = _line(xx, xy, yy, total, mean_x, mean_y)
    scale = voxel_weight[:, None, None].astype(np.float64)
    of_mean = scale * total
    all_mass = np.maximum(of_mean.sum(axis=0), 1e-9)
    scene = _line(
        (scale * xx).sum(axis=0),
        (scale * xy).sum(axis=0),
        (scale * yy).sum(axis=0),
        of_mean.sum(axis=0),
        (of_mean * mean_x).sum(axis=0) / all_mass,
        (of_mean * mean_y).sum(axis=0) / all_mass,
    )
    return LobeFit(voxels, scene)


def _line(
    xx: NDArray[np.float64],
    xy: NDArray[np.float64],
    yy: NDArray[np.float64],
    total: NDArray[np.float64],
    mean_x: NDArray[np.float64],
    mean_y: NDArray[np.float64],
) -> NDArray[np.float32]:
    prior = PRIOR_VARIANCE * np.maximum(total, 1e-9)
    slope = np.clip(xy / (xx + prior), *LIMITS)
    intercept = np.clip(mean_y - slope * mean_x, *LIMITS)
    explained = xy * xy / ((xx + prior) * (yy + prior))
    return np.stack([slope, intercept, explained], axis=-1).astype(np.float32)
