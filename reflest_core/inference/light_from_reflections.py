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
from reflest_core.inference.transport.reflected_patches import Reflection
from reflest_core.jit import compiled, kernel_array
from reflest_core.surface.surface_sample import SurfaceSample

TURNS, FURTHER_TURNS = 6, 1
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
    reflection: Reflection,
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
class _Mirrored:
    """What R observations mirror of U unknowns at ``rho_s = 1``: a lobe sees few patches.

    Attributes:
        starts: (R + 1,) observation r has the entries ``starts[r]:starts[r + 1]``.
        columns: Of each entry, the unknown.
        values: Of each entry, the response to that unknown.
    """

    starts: NDArray[np.int64]
    columns: NDArray[np.int32]
    values: NDArray[np.float32]

    def __matmul__(self, found: NDArray[np.float64]) -> NDArray[np.float32]:
        """(R,) from (U,)."""
        return _times(self.starts, self.columns, self.values, found.astype(np.float32))


@dataclass(frozen=True)
class _System:
    """One channel: R observations of V voxels, U unknowns that matter to them.

    Attributes:
        rho_s: Of the surface.
        matters: (1 + 2 P,) which unknowns matter.
        voxel_of: (R,) the voxel of each observation.
        target: (R,) colours less what is known of their reflections.
        noise: (R,) standard deviations of the target.
        is_bound: (R,) where clipped, so that the colour is at least that.
        diffuse: (V, U) responses to diffuse light.
        mirrored: (R, U) responses of the reflection.
    """

    rho_s: float
    matters: NDArray[np.bool_]
    voxel_of: NDArray[np.int64]
    target: NDArray[np.float32]
    noise: NDArray[np.float32]
    is_bound: NDArray[np.bool_]
    diffuse: NDArray[np.float32]
    mirrored: _Mirrored

    @staticmethod
    def of(
        sample: SurfaceSample,
        response: PatchResponse,
        reflection: Reflection,
        rho_s: float,
        channel: int,
    ) -> _System:
        colours = sample.colours[:, channel]
        diffuse = kernel_array(response.answers[channel], np.float32)
        voxel_of = kernel_array(sample.voxel_of, np.int64)
        reflects_seen = reflection.known[channel]  # is known, and taken from the target
        starts, columns = reflection.starts, reflection.columns
        values = kernel_array(reflection.values[channel], np.float32)
        matters = which_matter(_strongest(diffuse, voxel_of, starts, columns, values))
        place = np.cumsum(matters, dtype=np.int32) - np.int32(1)
        return _System(
            rho_s,
            matters,
            voxel_of,
            colours - np.float32(rho_s) * reflects_seen,
            np.hypot(
                RELATIVE * colours + LEAST,
                np.float32(COARSE * rho_s) * reflects_seen,
            ),
            kernel_array(sample.clipped[:, channel], np.bool_),
            np.take(diffuse, np.flatnonzero(matters), axis=1),
            _Mirrored(starts, place[columns], np.where(matters[columns], values, np.float32(0.0))),
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
        found, factors, share = start, start / max(float(start[0]), 1e-3), 0.0
        for turn in range(turns):
            share = min(self.rho_s / max(float(found[0]), LEAST_ALBEDO), MOST_GLOSS)
            is_first = turn == 0 and not is_found
            equations = self._equations(np.float32(share), found, factors, is_first)
            found, matrix = unknowns.most_likely(*equations, found)
            factors[1:] = found[1:] / max(float(found[0]), 1e-3)
        error = (self._error(share, found) / self.noise)[~self.is_bound]
        misfit = RELATIVE * float(np.sqrt(np.log1p(error**2).mean()))
        deviation = log_albedo_deviation(found, matrix)
        light = (unknowns.factors(found), max(float(found[0]), 1e-3), deviation, misfit)
        return light, found

    def _error(self, share: float, found: NDArray[np.float64]) -> NDArray[np.float32]:
        """(R,) model less target, where ``rho_s`` is the ``share`` of ``rho_d``."""
        diffuse = (self.diffuse @ found.astype(np.float32))[self.voxel_of]
        return np.asarray(diffuse + np.float32(share) * (self.mirrored @ found) - self.target)

    def _equations(
        self,
        share: np.float32,
        found: NDArray[np.float64],
        factors: NDArray[np.float64],
        is_first: bool,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Normal matrix (U, U) and vector (U,), by voxels: their diffuse answers are all views'."""
        light = np.stack([found, factors]).astype(np.float32)
        halves, pulls, of_mirrored, vector = _summed(
            self.mirrored.starts,
            self.mirrored.columns,
            self.mirrored.values,
            self.target,
            self.noise,
            self.is_bound,
            self.voxel_of,
            self.diffuse,
            self.diffuse @ light[0],
            light,
            share,
            np.float32(HIDDEN * self.rho_s),
            is_first,
        )
        half = (self.diffuse.T @ halves).astype(np.float64)
        return half + half.T + of_mirrored, vector + (pulls @ self.diffuse)


@compiled
def _strongest(
    diffuse: NDArray[np.float32],
    voxel_of: NDArray[np.int64],
    starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float32],
) -> NDArray[np.float32]:
    """(1, 1 + 2 P) the greatest answer of an observation to each unknown; ``diffuse`` by voxel."""
    strongest = np.zeros((1, diffuse.shape[1]), np.float32)
    for r in range(len(voxel_of)):
        own = diffuse[voxel_of[r]]
        if r == 0 or voxel_of[r] != voxel_of[r - 1]:
            for n in range(len(own)):
                strongest[0, n] = max(strongest[0, n], own[n])
        for entry in range(starts[r], starts[r + 1]):
            n = columns[entry]
            strongest[0, n] = max(strongest[0, n], own[n] + values[entry])
    return strongest


@compiled
def _times(
    starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float32],
    found: NDArray[np.float32],
) -> NDArray[np.float32]:
    product = np.zeros(len(starts) - 1, np.float32)
    for r in range(len(product)):
        for entry in range(starts[r], starts[r + 1]):
            product[r] += values[entry] * found[columns[entry]]
    return product


@compiled
def _summed(
    starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float32],
    targets: NDArray[np.float32],
    noises: NDArray[np.float32],
    is_bound: NDArray[np.bool_],
    voxel_of: NDArray[np.int64],
    diffuse: NDArray[np.float32],
    shaded: NDArray[np.float32],
    light: NDArray[np.float32],
    share: np.float32,
    hidden: np.float32,
    is_first: bool,
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float64], NDArray[np.float64]]:
    """Weigh observations and sum them; the arguments are those of :class:`_System`.

    ``shaded`` (V,) is what voxels send by the unknowns as they were found, the first row of
    ``light`` (2, U); the second is what patches hold. Bounds that are met, or are not known to be
    missed, do not count, and what is far from what was found loses weight.

    Returns by voxel (V, U) half of its weighted diffuse answers, and all of its mirrored ones; (V,)
    its weighted targets; then the mirrored answers' products with one another (U, U) and with the
    targets (U,).
    """
    halves, pulls = np.zeros(diffuse.shape, np.float32), np.zeros(len(diffuse), np.float32)
    masses = np.zeros(len(diffuse), np.float32)
    unknowns, none = diffuse.shape[1], np.float32(0.0)
    matrix, vector = np.zeros((unknowns, unknowns)), np.zeros(unknowns)
    for r in range(len(targets)):
        voxel, shining, unsure = voxel_of[r], none, none
        for entry in range(starts[r], starts[r + 1]):
            shining += values[entry] * light[0, columns[entry]]
            unsure += values[entry] * light[1, columns[entry]]
        error = none if is_first else shaded[voxel] + share * shining - targets[r]
        if is_bound[r] and error >= none:
            continue
        unsure *= hidden
        weight = np.float32(1.0) / (noises[r] * noises[r] + unsure * unsure + error * error)
        pull = weight * targets[r]
        masses[voxel] += weight
        pulls[voxel] += pull
        for entry in range(starts[r], starts[r + 1]):
            value = share * values[entry]
            halves[voxel, columns[entry]] += weight * value
            vector[columns[entry]] += value * pull
            for other in range(starts[r], starts[r + 1]):
                of_both = weight * value * share * values[other]
                matrix[columns[entry], columns[other]] += of_both
    for voxel in range(len(diffuse)):
        half = np.float32(0.5) * masses[voxel]
        for n in range(unknowns):
            halves[voxel, n] += half * diffuse[voxel, n]
    return halves, pulls, matrix, vector
