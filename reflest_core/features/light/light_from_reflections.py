# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Unseen and clipped light inferred from all that a surface sends back, gloss included.

Once ``rho_s`` and ``alpha`` are known from seen light (:mod:`.gloss_fit`), every observation is

    L = rho_d E(n) / pi + rho_s S(o, n, alpha)

with ``E`` and ``S`` linear in the light. A glossy surface mirrors what no camera looked at, and
so ties the strength of that light, and with it ``rho_d``, to ``rho_s``. Unknown are ``rho_d`` and
``rho_d`` times what each patch adds, in which reflections weigh by ``rho_s / rho_d`` of the turn
before.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.gloss_fit import GlossFit
from reflest_core.features.light.light_from_shading import ChannelLight, InferredLight
from reflest_core.features.light.light_patches import PatchResponse
from reflest_core.features.light.light_prior import (
    BRIGHT,
    LightPrior,
    Unknowns,
    log_albedo_deviation,
    which_matter,
)
from reflest_core.features.light.surface_sample import SurfaceSample

TURNS = 6
RELATIVE, LEAST = 0.07, 0.003
"""Standard deviation of a radiance: share of itself, and in units of the sensor's white."""
HIDDEN = 0.5
"""The same of what unknown light adds to a reflection: a patch is not even, and lobes are small."""
LEAST_ALBEDO, MOST_GLOSS = 0.03, 10.0
"""Least ``rho_d`` and greatest ``rho_s / rho_d`` with which reflections are weighed."""
FEWEST = 10
"""Unclipped observations, with fewer of which a channel says nothing."""


def infer_light_by_gloss(
    sample: SurfaceSample,
    response: PatchResponse,
    reflection: PatchResponse,
    gloss: GlossFit,
    albedo: NDArray[np.float32],
    prior: LightPrior = BRIGHT,
) -> InferredLight:
    """Explain the ``sample``'s colours, highlights and all.

    ``response``: of the sample's voxels. ``reflection``: of its observations, at the roughness that
    ``gloss`` expects. ``albedo``: (3,) to begin with.
    """
    rho_s = float(gloss.weight @ gloss.gloss)
    return InferredLight.of(
        [
            _infer_channel(
                sample, response, reflection, rho_s, float(albedo[channel]), channel, prior
            )
            for channel in range(3)
        ]
    )


def _infer_channel(
    sample: SurfaceSample,
    response: PatchResponse,
    reflection: PatchResponse,
    rho_s: float,
    albedo: float,
    channel: int,
    prior: LightPrior,
) -> ChannelLight:
    known = ~sample.clipped[:, channel]
    if known.sum() < FEWEST:
        return prior.mean.copy(), albedo, 1.0, 0.0
    colours = sample.colours[known, channel]
    target = colours - rho_s * reflection.seen[known, channel]
    noise = RELATIVE * colours + LEAST
    diffuse = response.columns(sample.voxel_of[known], channel)
    mirrored = reflection.columns(known, channel)
    mirrored[:, 0] = 0.0  # what reflects seen light is known, and taken from the target
    unknowns = Unknowns(which_matter(diffuse + mirrored), prior)
    diffuse, mirrored = diffuse[:, unknowns.matters], mirrored[:, unknowns.matters]
    found, factors = unknowns.expected(albedo), unknowns.expected(1.0)
    for turn in range(TURNS):
        share = min(rho_s / max(float(found[0]), LEAST_ALBEDO), MOST_GLOSS)
        columns = diffuse + np.float32(share) * mirrored
        unsure = HIDDEN * rho_s * (mirrored @ factors.astype(np.float32))
        variance = noise**2 + unsure**2
        weight = 1.0 / variance
        if turn > 0:
            weight = weight / (1.0 + (columns @ found - target) ** 2 / variance)
        found, matrix = unknowns.most_likely(columns, target, weight, found)
        factors[1:] = found[1:] / max(float(found[0]), 1e-3)
    error = (columns @ found - target) / noise
    misfit = RELATIVE * float(np.sqrt(np.log1p(error**2).mean()))
    deviation = log_albedo_deviation(found, matrix)
    return unknowns.factors(found), max(float(found[0]), 1e-3), deviation, misfit
