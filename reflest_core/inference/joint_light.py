# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light of a scene, completed from all of its segments together.

Surfaces of several colours and normals under one light tie its strength, where one alone leaves it
open: what is too bright to be a plausible albedo under a weak light, on any segment, needs more
light for all of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss.gloss_fit import GlossFit, fit_gloss
from reflest_core.inference.joint_system import ChannelState, ChannelSystem
from reflest_core.inference.light_prior import SCENE, LightPrior
from reflest_core.inference.transport.irradiance import incoming
from reflest_core.inference.transport.light_patches import (
    LightParts,
    completed_light,
    diffuse_response,
    patches_of,
)
from reflest_core.inference.transport.patch_grid import (
    patch_image,
    texels_of_patches,
)
from reflest_core.inference.transport.reflected_patches import scene_reflection
from reflest_core.inference.transport.scene_occluders import SceneOccluders
from reflest_core.inference.transport.ward_lobe import lobe_radiance
from reflest_core.light.completion import (
    CLIPPED,
    RADIANCE,
    SEEN,
    LightPyramid,
    complete,
)
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.light.light_map import ObservedLight
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.surface_sample import sampled
from reflest_core.surface.thinning import thinned

MOST_SAMPLED, FEWEST_EACH, MOST_EACH = 1500, 24, 192
"""Voxels of all segments together, and bounds for each."""
EVERY = 2
"""Of the sampled observations the light is inferred from every second."""
TURNS, TURNS_AGAIN = 12, 6
"""Gauss-Newton steps from the prior, and from an earlier light; after them albedos hardly
change."""
FIRST_ALBEDO = 0.2
USUAL_ROUGHNESS = 4
"""Index into :data:`.ROUGHNESSES`, for a segment with too few observations to fit gloss."""
FEWEST = 20
"""Observations of a segment, with fewer of which its gloss is not fitted."""
COMPLETED_TRUST = 0.5
"""How far completed light is believed where a lobe looks into it, beside light that was seen."""


@dataclass(frozen=True)
class SegmentGloss:
    """Gloss of S segments, as the light's inference needs it.

    Attributes:
        rho_s: (S,) float64.
        roughness: (S,) int64 index into :data:`.ROUGHNESSES`.
    """

    rho_s: NDArray[np.float64]
    roughness: NDArray[np.int64]


@dataclass(frozen=True)
class JointLight:
    """The light of a scene and what it was inferred with; S segments, P patches.

    Attributes:
        filled: the light after pull and push alone.
        light: the completed light.
        factors: (3, 2 P) what the patches hold: a factor to the fill of unseen directions, then
            radiance above white where clipped.
        factor_deviations: (3, 2 P) their standard deviations.
        rho_d: (S, 3), NaN for a segment without observations.
        rho_d_log_deviation: (S, 3) standard deviation of ``log rho_d``.
        rho_s: (S,).
        rho_s_deviation: (S,) its standard deviation.
        roughness: (S,) index into :data:`.ROUGHNESSES`.
        misfit: (3,) root mean square of the observations' relative errors.
        condition: condition number of the channel that is determined worst, at least 1.
    """

    filled: LightPyramid
    light: LightPyramid
    factors: NDArray[np.float64]
    factor_deviations: NDArray[np.float64]
    rho_d: NDArray[np.float64]
    rho_d_log_deviation: NDArray[np.float64]
    rho_s: NDArray[np.float64]
    rho_s_deviation: NDArray[np.float64]
    roughness: NDArray[np.int64]
    misfit: NDArray[np.float64]
    condition: float

    def deviation(self) -> NDArray[np.float32]:
        """(N, N, 3) standard deviation of the completed radiance at the finest resolution."""
        fine = self.filled.levels[0]
        size = len(fine)
        unseen, excess = (patch_image(part, size) for part in patches_of(self.factor_deviations))
        is_unseen = 1.0 - fine[..., SEEN : SEEN + 1]
        return np.asarray(
            np.hypot(is_unseen * fine[..., RADIANCE] * unseen, self.filled.excess * excess),
            np.float32,
        )


class JointInference:
    """Infers the light of one snapshot; rounds may go on from each other."""

    def __init__(
        self,
        surface: ObservedSurface,
        labels: NDArray[np.int64],
        observed: ObservedLight,
        occluders: SceneOccluders,
    ) -> None:
        """Choose voxels of every segment, and compute how they respond to the light.

        Args:
            surface: V voxels with their observations.
            labels: (V,) segment of each voxel, -1 for voxels to leave out.
            observed: the light as it was seen.
            occluders: surfels of the whole scene.
        """
        self.observed, self.filled = observed, complete(observed)
        fine = self.filled.levels[0]
        texels = texels_of_patches(len(fine))
        self._fill = fine[..., RADIANCE].reshape(-1, 3)[texels].mean(axis=1)
        self.segments = int(labels.max(initial=-1)) + 1
        voxels, self._segment_of_voxel = _chosen_voxels(surface, labels, self.segments)
        self._sample = sampled(surface, voxels)
        weights = cosine_weights(self._sample.normals)
        self._sight = occluders.sight(surface.positions[voxels], self._sample.normals, weights)
        parts = LightParts.of(observed, self.filled)
        self._diffuse = diffuse_response(parts, incoming(weights, self._sight)).answers

    def gloss(
        self, light: LightPyramid | None = None
    ) -> tuple[list[GlossFit | None], SegmentGloss]:
        """Fit the gloss of every segment under the light.

        Args:
            light: the completed light; None for the light as it was seen.

        Returns:
            The fits, None where a segment has too few observations, and their means.
        """
        sample = self._sample
        lobes = lobe_radiance(
            light or self.filled,
            sample.normals[sample.voxel_of],
            sample.directions,
            self._sight.of(sample.voxel_of),
        )
        if light is not None:
            lobes[..., SEEN] = COMPLETED_TRUST + (1.0 - COMPLETED_TRUST) * lobes[..., SEEN]
            lobes[..., CLIPPED] = 0.0
        segment_of = self._segment_of_voxel[sample.voxel_of]
        fits: list[GlossFit | None] = []
        rho_s = np.zeros(self.segments)
        roughness = np.full(self.segments, USUAL_ROUGHNESS)
        for segment in range(self.segments):
            rows = np.flatnonzero(segment_of == segment)
            if len(rows) < FEWEST:
                fits.append(None)
                continue
            _, voxel_of = np.unique(sample.voxel_of[rows], return_inverse=True)
            fit = fit_gloss(sample.colours[rows], sample.clipped[rows], lobes[rows], voxel_of)
            fits.append(fit)
            rho_s[segment] = float(fit.weight @ fit.gloss)
            roughness[segment] = fit.roughness
        return fits, SegmentGloss(rho_s, roughness)

    def infer(
        self,
        gloss: SegmentGloss,
        start: JointLight | None = None,
        turns: int = TURNS,
        light_prior: LightPrior = SCENE,
        known: JointLight | None = None,
    ) -> JointLight:
        """Solve for the light, and ``rho_d`` and ``rho_s`` of each segment.

        Args:
            gloss: ``rho_s``, a prior, and the roughness, which is kept.
            start: a solution for the same segments to begin from; None begins from the prior.
            turns: Gauss-Newton steps.
            light_prior: what unseen and clipped light may hold.
            known: a solution for other segments, whose light is begun from.
        """
        sample = self._sample.every(EVERY)
        segment_of = self._segment_of_voxel[sample.voxel_of]
        present, starts, row_of = np.unique(segment_of, return_index=True, return_inverse=True)
        mirrored = scene_reflection(
            self.filled,
            gloss.roughness[segment_of],
            sample.normals[sample.voxel_of],
            sample.directions,
            self._sight.of(sample.voxel_of),
        )
        solutions = []
        for channel in range(3):
            prior = light_prior.of_patches(channel, self._fill)
            system = ChannelSystem(
                sample.colours[:, channel],
                sample.clipped[:, channel],
                starts,
                row_of.reshape(-1),
                sample.voxel_of,
                self._diffuse[channel],
                mirrored.answers[channel],
                gloss.rho_s[present],
                prior,
            )
            light = prior.mean if known is None else known.factors[channel]
            state = ChannelState(np.full(len(present), FIRST_ALBEDO), gloss.rho_s[present], light)
            if start is not None:
                state = ChannelState(
                    start.rho_d[present, channel], start.rho_s[present], start.factors[channel]
                )
            solutions.append(system.solve(state, turns, start is not None))
        factors = np.stack([one.state.light for one in solutions])
        rho_d, deviation = np.full((2, self.segments, 3), np.nan)
        rho_d[present] = np.stack([one.state.rho_d for one in solutions], axis=1)
        deviation[present] = np.stack([one.log_albedo_deviation for one in solutions], axis=1)
        rho_s, rho_s_deviation = gloss.rho_s.copy(), np.full(self.segments, np.nan)
        rho_s[present] = np.mean([one.state.rho_s for one in solutions], axis=0)
        rho_s_deviation[present] = np.mean([one.gloss_deviation for one in solutions], axis=0)
        return JointLight(
            self.filled,
            completed_light(self.observed, self.filled, *patches_of(factors)),
            factors,
            np.stack([one.light_deviation for one in solutions]),
            rho_d,
            deviation,
            rho_s,
            rho_s_deviation,
            gloss.roughness,
            np.array([one.misfit for one in solutions]),
            max(one.condition for one in solutions),
        )


def _chosen_voxels(
    surface: ObservedSurface, labels: NDArray[np.int64], segments: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Voxels, by rising segment, and the segment of each."""
    each = int(np.clip(MOST_SAMPLED // max(segments, 1), FEWEST_EACH, MOST_EACH))
    counts = surface.observation_counts
    chosen = []
    for segment in range(segments):
        members = np.flatnonzero(labels == segment)
        chosen.append(members[thinned(counts[members], each)] if len(members) else members)
    sizes = [len(members) for members in chosen]
    return np.concatenate([*chosen, np.zeros(0, np.int64)]), np.repeat(np.arange(segments), sizes)
