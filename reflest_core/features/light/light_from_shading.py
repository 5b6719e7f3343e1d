# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Unseen and clipped light inferred from the surface that it falls on.

A convex surface of one material shades as its light falls: ``D(n) = rho_d E(n) / pi``. With the
light in patches, that is linear in ``rho_d`` and in ``rho_d`` times what each patch adds; all are
at least 0. Priors keep what the shading does not tell at plausible values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.light_patches import PatchResponse
from reflest_core.features.light.light_prior import (
    ALBEDO,
    EVEN,
    LightPrior,
    Unknowns,
    log_albedo_deviation,
    which_matter,
)
from reflest_core.features.light.patch_grid import PATCHES

NOISE, DARK_NOISE = 0.07, 0.01
"""Standard deviation of a colour about the model: share of itself, and of the brightest."""
ROUNDS = 3
"""The priors' widths are in units of ``rho_d``, which is known after a round."""

ChannelLight = tuple[NDArray[np.float64], float, float, float]
"""Factors (2 P,) of the patches, albedo, deviation of its logarithm, misfit."""


@dataclass(frozen=True)
class InferredLight:
    """What the surface tells; all float32.

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

    @staticmethod
    def of(channels: list[ChannelLight]) -> InferredLight:
        """Three channels as one."""
        factors, *scalars = (np.array(parts, np.float32) for parts in zip(*channels, strict=True))
        return InferredLight(factors[:, :PATCHES].T, factors[:, PATCHES:].T, *scalars)


def infer_light(
    response: PatchResponse, colours: NDArray[np.float32], priors: Sequence[LightPrior] = (EVEN,)
) -> list[InferredLight]:
    """Explain diffuse ``colours`` (V, 3), linear, under each prior; those at 1 say nothing."""
    channels = [_System.of(response, colours[:, channel], channel) for channel in range(3)]
    return [
        InferredLight.of([channel.explained(prior) for channel in channels]) for prior in priors
    ]


@dataclass(frozen=True)
class _System:
    """One channel's least squares: U unknowns that matter, R colours.

    ``used``: (R, U) answers, ``target``: (R,) colours, ``noise``: (R,) their standard deviations.
    ``matrix``: (U, U) and ``vector``: (U,), the normal equations.
    """

    matters: NDArray[np.bool_]
    used: NDArray[np.float64]
    target: NDArray[np.float64]
    noise: NDArray[np.float64]
    matrix: NDArray[np.float64]
    vector: NDArray[np.float64]

    @staticmethod
    def of(response: PatchResponse, colours: NDArray[np.float32], channel: int) -> _System:
        known = colours < 1.0
        target = colours[known].astype(np.float64)
        noise = NOISE * target + DARK_NOISE * max(float(target.max(initial=0.0)), 1e-3)
        columns = response.columns(known, channel)
        matters = which_matter(columns)
        used = columns[:, matters].astype(np.float64)
        weighted = used / noise[:, None]
        return _System(
            matters, used, target, noise, weighted.T @ weighted, weighted.T @ (target / noise)
        )

    def explained(self, prior: LightPrior) -> ChannelLight:
        unknowns = Unknowns(self.matters, prior)
        found = unknowns.expected(ALBEDO[0])
        for _ in range(ROUNDS):
            found, matrix = unknowns.most_likely(self.matrix, self.vector, found)
        errors = (self.used @ found - self.target) / self.noise
        misfit = NOISE * float(np.sqrt((errors**2).mean())) if len(errors) else 0.0
        deviation = log_albedo_deviation(found, matrix)
        return unknowns.factors(found), max(float(found[0]), 1e-3), deviation, misfit
