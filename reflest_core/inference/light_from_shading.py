# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Unseen and clipped light inferred from the surface that it falls on.

A convex surface of one material shades as its light falls: ``D(n) = rho_d E(n) / pi``. With the
light in patches, that is linear in ``rho_d`` and in ``rho_d`` times what each patch adds; all are
at least 0. Priors keep what the shading does not determine at plausible values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.light_prior import (
    ALBEDO,
    BRIGHT,
    LightPrior,
    Unknowns,
    log_albedo_deviation,
    normal_equations,
    which_matter,
)
from reflest_core.inference.transport.light_patches import PatchResponse
from reflest_core.inference.transport.patch_grid import PATCHES

NOISE, DARK_NOISE = 0.07, 0.01
"""Standard deviation of a colour about the model: share of itself, and of the brightest."""
ROUNDS = 3
"""The prior's widths are in units of ``rho_d``, which is known after a round; highlights and what
the object hides lose their weight."""

ChannelLight = tuple[NDArray[np.float64], float, float, float]
"""Factors (2 P,) of the patches, albedo, deviation of its logarithm, misfit."""


@dataclass(frozen=True)
class InferredLight:
    """The light that a material's colours give; P patches, all float32.

    Attributes:
        unseen: (P, 3) factor to each patch's smooth fill.
        excess: (P, 3) radiance above white where a patch was clipped.
        albedo: (3,) the ``rho_d`` that goes with it.
        deviation: (3,) standard deviation of ``log rho_d``.
        misfit: (3,) root mean square of the colours' relative errors.
    """

    unseen: NDArray[np.float32]
    excess: NDArray[np.float32]
    albedo: NDArray[np.float32]
    deviation: NDArray[np.float32]
    misfit: NDArray[np.float32]

    @staticmethod
    def of(channels: list[ChannelLight]) -> InferredLight:
        """Join three channels.

        Args:
            channels: red, green, blue.
        """
        factors, *scalars = (np.array(parts, np.float32) for parts in zip(*channels, strict=True))
        return InferredLight(factors[:, :PATCHES].T, factors[:, PATCHES:].T, *scalars)

    @staticmethod
    def mean(found: Sequence[InferredLight]) -> InferredLight:
        """Join what several sets of observations give; of the albedo the geometric mean.

        Args:
            found: Of each set.
        """
        if len(found) == 1:
            return found[0]
        means = {
            one.name: np.mean([getattr(light, one.name) for light in found], axis=0)
            for one in fields(InferredLight)
        }
        means["albedo"] = np.exp(np.mean([np.log(light.albedo) for light in found], axis=0))
        return InferredLight(**means)


def infer_from_shading(
    response: PatchResponse, colours: NDArray[np.float32], prior: LightPrior = BRIGHT
) -> InferredLight:
    """Explain the diffuse colours of a material by light in patches.

    Args:
        response: of V voxels to diffuse light.
        colours: (V, 3) linear, without highlights; saturated ones do not count.
        prior: of the light.
    """
    return InferredLight.of(
        [
            _infer_channel(response, colours[:, channel], channel, prior.of_channel(channel))
            for channel in range(3)
        ]
    )


def _infer_channel(
    response: PatchResponse, colours: NDArray[np.float32], channel: int, prior: LightPrior
) -> ChannelLight:
    known = colours < 1.0
    target = colours[known]
    noise = NOISE * target + DARK_NOISE * max(float(target.max(initial=0.0)), 1e-3)
    columns = response.answers[channel]
    columns = columns if known.all() else columns[known]
    unknowns = Unknowns(which_matter(columns), prior)
    # np.take copies columns faster than an index does.
    columns = np.take(columns, np.flatnonzero(unknowns.matters), axis=1)
    found, errors = unknowns.expected(ALBEDO[0]), np.zeros_like(target)
    for _ in range(ROUNDS):
        weight = 1.0 / (noise**2 * (1.0 + errors**2))
        equations = normal_equations(columns, target, weight.astype(np.float32))
        found, matrix = unknowns.most_likely(*equations, found)
        errors = (columns @ found.astype(np.float32) - target) / noise
    misfit = NOISE * float(np.sqrt(np.log1p(errors**2).mean())) if len(errors) else 0.0
    deviation = log_albedo_deviation(found, matrix)
    return unknowns.factors(found), max(float(found[0]), 1e-3), deviation, misfit
