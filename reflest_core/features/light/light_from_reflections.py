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

from collections.abc import Sequence
from dataclasses import dataclass

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
COARSE = 0.1
"""The same of what is known of a reflection, as a share of it."""
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
    priors: Sequence[LightPrior] = (BRIGHT,),
) -> list[InferredLight]:
    """Explain the ``sample``'s colours, highlights and all, under each prior.

    ``response``: of the sample's voxels. ``reflection``: of its observations, at the roughness that
    ``gloss`` expects. ``albedo``: (3,) to begin with.
    """
    rho_s = float(gloss.weight @ gloss.gloss)
    systems = [_System.of(sample, response, reflection, rho_s, channel) for channel in range(3)]
    return [
        InferredLight.of(
            [
                system.explained(prior.of_channel(channel), float(albedo[channel]))
                for channel, system in enumerate(systems)
            ]
        )
        for prior in priors
    ]


@dataclass(frozen=True)
class _System:
    """One channel: R observations, U unknowns that matter to them.

    ``target``: (R,) colours less what is known of their reflections, ``noise``: (R,) standard
    deviations. ``is_bound``: (R,) where clipped, so that the colour is at least that. ``diffuse``,
    ``mirrored``: (R, U) answers, the latter at ``rho_s = 1``.
    """

    rho_s: float
    matters: NDArray[np.bool_]
    target: NDArray[np.float32]
    noise: NDArray[np.float32]
    is_bound: NDArray[np.bool_]
    diffuse: NDArray[np.float32]
    mirrored: NDArray[np.float32]

    @staticmethod
    def of(
        sample: SurfaceSample,
        response: PatchResponse,
        reflection: PatchResponse,
        rho_s: float,
        channel: int,
    ) -> _System:
        colours = sample.colours[:, channel]
        diffuse = response.columns(sample.voxel_of, channel)
        mirrored = reflection.columns(slice(None), channel)
        mirrored[:, 0] = 0.0  # what reflects seen light is known, and taken from the target
        matters = which_matter(diffuse + mirrored)
        return _System(
            rho_s,
            matters,
            colours - np.float32(rho_s) * reflection.seen[:, channel],
            np.hypot(
                RELATIVE * colours + LEAST,
                np.float32(COARSE * rho_s) * reflection.seen[:, channel],
            ),
            sample.clipped[:, channel],
            diffuse[:, matters],
            mirrored[:, matters],
        )

    def explained(self, prior: LightPrior, albedo: float) -> ChannelLight:
        """The light and the albedo, beginning with this one."""
        if np.count_nonzero(~self.is_bound) < FEWEST:
            return prior.mean.copy(), albedo, 1.0, 0.0
        unknowns = Unknowns(self.matters, prior)
        found, factors = unknowns.expected(albedo), unknowns.expected(1.0)
        for turn in range(TURNS):
            share = min(self.rho_s / max(float(found[0]), LEAST_ALBEDO), MOST_GLOSS)
            columns = self.diffuse + np.float32(share) * self.mirrored
            unsure = np.float32(HIDDEN * self.rho_s) * (self.mirrored @ factors.astype(np.float32))
            variance = self.noise**2 + unsure**2
            if turn == 0:
                weight = np.where(self.is_bound, np.float32(0.0), 1.0 / variance)
            else:
                error = self._error(columns, found)
                is_met = self.is_bound & (error >= 0.0)
                weight = np.where(is_met, np.float32(0.0), 1.0 / (variance + error**2))
            found, matrix = unknowns.most_likely(columns, self.target, weight, found)
            factors[1:] = found[1:] / max(float(found[0]), 1e-3)
        error = (self._error(columns, found) / self.noise)[~self.is_bound]
        misfit = RELATIVE * float(np.sqrt(np.log1p(error**2).mean()))
        deviation = log_albedo_deviation(found, matrix)
        return unknowns.factors(found), max(float(found[0]), 1e-3), deviation, misfit

    def _error(
        self, columns: NDArray[np.float32], found: NDArray[np.float64]
    ) -> NDArray[np.float32]:
        return np.asarray(columns @ found.astype(np.float32) - self.target)
