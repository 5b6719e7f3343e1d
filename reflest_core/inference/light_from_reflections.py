# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Unseen and clipped light inferred from all that a surface sends back, gloss included.

Once ``rho_s`` and ``alpha`` are known from seen light (:mod:`.gloss.gloss_fit`), observations are

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

from reflest_core.inference.gloss.gloss_fit import GlossFit
from reflest_core.inference.light_from_shading import ChannelLight, InferredLight
from reflest_core.inference.light_prior import (
    BRIGHT,
    LightPrior,
    Unknowns,
    log_albedo_deviation,
    which_matter,
)
from reflest_core.inference.transport.light_patches import PatchResponse
from reflest_core.surface.surface_sample import SurfaceSample

TURNS, FURTHER_TURNS = 6, 2
"""Under the first prior, and under each other, which begin where the first one ended."""
RELATIVE, LEAST = 0.05, 0.003
"""Standard deviation of a radiance: share of itself, and in units of the sensor's white."""
COARSE = 0.1
"""The same of what is known of a reflection, as a share of it."""
HIDDEN = 0.25
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
    """Explain the colours of a sample, highlights included, under each prior.

    Args:
        sample: observations.
        response: of the sample's voxels to diffuse light.
        reflection: of its observations, at the roughness that ``gloss`` expects.
        gloss: fitted under the light that was seen.
        albedo: (3,) ``rho_d`` to begin with.
        priors: of the light; each fit after the first begins where the one before ended.

    Returns:
        The light by each prior.
    """
    rho_s = float(gloss.weight @ gloss.gloss)
    channels = []
    for channel in range(3):
        system = _System.of(sample, response, reflection, rho_s, channel)
        of_channel = [prior.of_channel(channel) for prior in priors]
        channels.append(system.explained(of_channel, float(albedo[channel])))
    return [InferredLight.of(list(of_prior)) for of_prior in zip(*channels, strict=True)]


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
        diffuse = np.take(response.answers[channel], sample.voxel_of, axis=0)
        reflects_seen = reflection.answers[channel, :, 0]
        mirrored = reflection.answers[channel].copy()
        mirrored[:, 0] = 0.0  # what reflects seen light is known, and taken from the target
        matters = which_matter(diffuse + mirrored)
        used = np.flatnonzero(matters)
        return _System(
            rho_s,
            matters,
            colours - np.float32(rho_s) * reflects_seen,
            np.hypot(
                RELATIVE * colours + LEAST,
                np.float32(COARSE * rho_s) * reflects_seen,
            ),
            sample.clipped[:, channel],
            np.take(diffuse, used, axis=1),
            np.take(mirrored, used, axis=1),
        )

    def explained(self, priors: Sequence[LightPrior], albedo: float) -> list[ChannelLight]:
        """The light and the albedo under each prior, beginning with this one."""
        if np.count_nonzero(~self.is_bound) < FEWEST:
            return [(prior.mean.copy(), albedo, 1.0, 0.0) for prior in priors]
        first, *others = (Unknowns(self.matters, prior) for prior in priors)
        expected = first.expected(albedo)
        light, found = self._explained(first, expected, TURNS, is_found=False)
        lights = [light]
        for unknowns in others:
            light, found = self._explained(unknowns, found, FURTHER_TURNS, is_found=True)
            lights.append(light)
        return lights

    def _explained(
        self, unknowns: Unknowns, start: NDArray[np.float64], turns: int, is_found: bool
    ) -> tuple[ChannelLight, NDArray[np.float64]]:
        """The light, and the unknowns as they were found, to go on from.

        What is far from the answer before loses weight, and so from the ``start`` if that was found
        and not just expected.
        """
        found, factors = start, start / max(float(start[0]), 1e-3)
        for turn in range(turns):
            share = min(self.rho_s / max(float(found[0]), LEAST_ALBEDO), MOST_GLOSS)
            columns = self.diffuse + np.float32(share) * self.mirrored
            unsure = np.float32(HIDDEN * self.rho_s) * (self.mirrored @ factors.astype(np.float32))
            variance = self.noise**2 + unsure**2
            if turn == 0 and not is_found:
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
        light = (unknowns.factors(found), max(float(found[0]), 1e-3), deviation, misfit)
        return light, found

    def _error(
        self, columns: NDArray[np.float32], found: NDArray[np.float64]
    ) -> NDArray[np.float32]:
        return np.asarray(columns @ found.astype(np.float32) - self.target)
