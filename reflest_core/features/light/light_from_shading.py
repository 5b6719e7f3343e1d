# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Unseen and clipped light inferred from the surface that it falls on.

A convex surface of one material shades as its light falls: ``D(n) = rho_d E(n) / pi``. With the
light in patches, that is linear in ``rho_d`` and in ``rho_d`` times what each patch adds; all are
at least 0. Priors keep what the shading does not tell at plausible values.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.light_patches import PATCHES, DiffuseResponse
from reflest_core.features.light.nonnegative import nonnegative_minimum

NOISE, DARK_NOISE = 0.07, 0.01
"""Standard deviation of a colour about the model: share of itself, and of the brightest."""
ALBEDO = (0.3, 0.4)
"""Prior mean and standard deviation of ``rho_d``."""
ROUNDS = 3
"""The priors' widths are in units of ``rho_d``, which is known after a round."""


@dataclass(frozen=True)
class LightPrior:
    """Mean and standard deviation of what a patch holds.

    ``unseen``: in multiples of its smooth fill. ``excess``: radiance above white where clipped, in
    multiples of white.
    """

    unseen: tuple[float, float]
    excess: tuple[float, float] = (3.0, 12.0)


EVEN = LightPrior((1.0, 1.2))
"""Unseen light is about as bright as what was seen beside it."""
FREE = LightPrior((3.0, 6.0))
"""It may be a bright sky above a scan that only ever looked down."""


@dataclass(frozen=True)
class InferredLight:
    """What the shading tells; all float32.

    ``unseen``: (P, 3), factor to each patch's smooth fill. ``excess``: (P, 3), radiance above white
    where a patch was clipped. ``albedo``: (3,), the ``rho_d`` that goes with it. ``deviation``:
    (3,), the standard deviation of ``log rho_d`` that it leaves. ``misfit``: (3,), root mean square
    of the colours' relative errors.
    """

    unseen: NDArray[np.float32]
    excess: NDArray[np.float32]
    albedo: NDArray[np.float32]
    deviation: NDArray[np.float32]
    misfit: NDArray[np.float32]


def infer_light(
    response: DiffuseResponse, colours: NDArray[np.float32], prior: LightPrior = EVEN
) -> InferredLight:
    """Explain diffuse ``colours`` (V, 3), linear; those at 1 are clipped and say nothing."""
    parts = [_infer_channel(response, colours[:, channel], channel, prior) for channel in range(3)]
    unseen, excess, albedo, deviation, misfit = zip(*parts, strict=True)
    return InferredLight(
        np.stack(unseen, axis=-1).astype(np.float32),
        np.stack(excess, axis=-1).astype(np.float32),
        np.array(albedo, np.float32),
        np.array(deviation, np.float32),
        np.array(misfit, np.float32),
    )


def _infer_channel(
    response: DiffuseResponse, colours: NDArray[np.float32], channel: int, prior: LightPrior
) -> tuple[NDArray[np.float64], NDArray[np.float64], float, float, float]:
    known = colours < 1.0
    target = colours[known].astype(np.float64)
    noise = NOISE * target + DARK_NOISE * max(float(target.max(initial=0.0)), 1e-3)
    columns = np.concatenate(
        [
            response.seen[known, channel, None],
            response.unseen[known, :, channel],
            response.excess[known],
        ],
        axis=1,
    ).astype(np.float64)
    matters = columns.max(axis=0, initial=0.0) > 1e-4 * max(float(columns.max(initial=0.0)), 1e-9)
    matters[0] = True
    prior_mean = np.repeat([prior.unseen[0], prior.excess[0]], PATCHES)[matters[1:]]
    prior_width = np.repeat([prior.unseen[1], prior.excess[1]], PATCHES)[matters[1:]]
    used = columns[:, matters]
    weighted = used / noise[:, None]
    data_matrix, data_vector = weighted.T @ weighted, weighted.T @ (target / noise)
    albedo = ALBEDO[0]
    found = albedo * np.concatenate([[1.0], prior_mean])
    for _ in range(ROUNDS):
        precision = 1.0 / (prior_width * max(albedo, 0.02)) ** 2
        matrix, vector = data_matrix.copy(), data_vector.copy()
        diagonal = np.arange(1, len(matrix))
        matrix[diagonal, diagonal] += precision
        matrix[0, 1:] -= precision * prior_mean
        matrix[1:, 0] -= precision * prior_mean
        matrix[0, 0] += (precision * prior_mean**2).sum() + ALBEDO[1] ** -2
        vector[0] += ALBEDO[0] * ALBEDO[1] ** -2
        found = nonnegative_minimum(matrix, vector, found)
        albedo = float(found[0])
    free = found > 0.0
    free[0] = True
    albedo = max(albedo, 1e-3)
    variance = np.linalg.solve(matrix[np.ix_(free, free)], np.eye(int(free.sum()), 1)[:, 0])[0]
    errors = (used @ found - target) / noise
    factors = np.repeat([prior.unseen[0], prior.excess[0]], PATCHES)
    factors[matters[1:]] = found[1:] / albedo
    misfit = NOISE * float(np.sqrt((errors**2).mean())) if len(errors) else 0.0
    return factors[:PATCHES], factors[PATCHES:], albedo, float(np.sqrt(variance)) / albedo, misfit
