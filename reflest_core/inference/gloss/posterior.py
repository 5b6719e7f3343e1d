# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The posterior of roughness, for a surface or for segments that share their gloss."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss.identifiability import FEWEST_VOXELS, LEAST_GAIN, identifiability
from reflest_core.inference.gloss.likelihood import fit_by_likelihood
from reflest_core.inference.gloss.lobes import SEEN, lobe_light
from reflest_core.inference.gloss.rated_surface import CHOSEN, TRUST, RatedSurface
from reflest_core.inference.transport.irradiance import DARKEST, mean_radiance
from reflest_core.light.completion import RADIANCE, LightPyramid
from reflest_core.surface.observed_surface import ObservedSurface

ALPHAS = np.geomspace(0.01, 0.35, 12)
"""Roughnesses that are compared."""
REFERENCE = 7
"""Index of the roughness whose lobe decides how far an observation's light was seen. One for all
roughnesses, so that all are compared on the same observations."""
WIDENING = 2.0
HALVINGS = 3
PARTS = 2**HALVINGS
"""Spatial parts of equal size, whose errors are nearly independent of each other's."""


@dataclass(frozen=True)
class GlossPosterior:
    """What a surface's observations say about roughness, at K roughnesses.

    Attributes:
        alphas: (K,) roughnesses, rising.
        log_likelihood: (K,) at the best ``rho_s`` of each; the maximum is 0.
        rho_s: (K,) the best at each roughness.
        rho_d: (S, K, 3) linear, of each segment under the given light; NaN where none of its voxels
            was chosen.
        probability: (K,) posterior under a flat prior of ``ln alpha``, with the likelihood raised
            to the power that its parts' disagreement asks for; sums to 1.
        alpha: Exponential of the posterior mean of ``ln alpha``.
        log_alpha_stddev: Standard deviation of ``ln alpha``.
        delta_log_likelihood: Over ``rho_s = 0``.
        effective_voxels: Sum of the chosen voxels' trust.
        is_identifiable: Whether ``alpha`` can be determined.
        reason: Why not, as a clause; "" where it can.
    """

    alphas: NDArray[np.float64]
    log_likelihood: NDArray[np.float64]
    rho_s: NDArray[np.float64]
    rho_d: NDArray[np.float64]
    probability: NDArray[np.float64]
    alpha: float
    log_alpha_stddev: float
    delta_log_likelihood: float
    effective_voxels: float
    is_identifiable: bool
    reason: str

    @property
    def alpha_stddev(self) -> float:
        """Standard deviation of :attr:`alpha`, to first order."""
        return self.alpha * self.log_alpha_stddev

    @property
    def rho_s_at_alpha(self) -> float:
        """``rho_s`` at :attr:`alpha`."""
        return float(np.interp(math.log(self.alpha), np.log(self.alphas), self.rho_s))


@dataclass(frozen=True)
class _Observations:
    """The chosen voxels' usable observations, grouped by voxel.

    Attributes:
        voxels: (V,) indices into the surface.
        offsets: (V + 1,) of each voxel's observations.
        directions: (O, 3) unit, towards the camera.
        colours: (O, 3) 8-bit sRGB.
    """

    voxels: NDArray[np.int64]
    offsets: NDArray[np.int64]
    directions: NDArray[np.float32]
    colours: NDArray[np.uint8]

    @staticmethod
    def of(
        surface: ObservedSurface, rated: RatedSurface, voxels: NDArray[np.int64]
    ) -> _Observations:
        counts = surface.observation_counts[voxels]
        starts = surface.offsets[voxels] - (np.cumsum(counts) - counts)
        rows = np.repeat(starts, counts) + np.arange(counts.sum())
        rows = rows[rated.is_usable[rows]]
        usable = rated.counts[voxels]
        directions = surface.directions_of(rows, np.repeat(voxels, usable))
        offsets = np.concatenate([[0], np.cumsum(usable)])
        return _Observations(voxels, offsets, directions, surface.colours[rows])


def gloss_posterior(
    surface: ObservedSurface,
    light: LightPyramid,
    segments: Sequence[NDArray[np.int64]],
    rated: RatedSurface | None = None,
    most: int = CHOSEN,
    least_gain: float = LEAST_GAIN,
) -> GlossPosterior:
    """Compare roughnesses by the observations of ``segments`` that hold most information.

    Args:
        surface: World frame, metres.
        light: The completed light, world frame, with the share that was seen.
        segments: Voxel indices of each segment; all share ``rho_s`` and ``alpha``, and each has an
            albedo of its own.
        rated: What :meth:`.RatedSurface.of` gave for this surface and light; None to rate it here.
        most: Voxels that are explained at most. Fewer take less time and leave more uncertainty.
        least_gain: Log-likelihood over ``rho_s = 0``, below which roughness cannot be determined.

    Returns:
        The posterior; flat and not identifiable where no voxel qualifies.
    """
    rated = rated or RatedSurface.of(surface, light)
    union = np.concatenate([*segments, np.zeros(0, np.int64)])
    chosen = _Observations.of(surface, rated, rated.choose(union, most))
    voxels, counts = chosen.voxels, np.diff(chosen.offsets)
    deviations = rated.deviations[voxels, None].astype(np.float64)
    lobes = lobe_light(
        light,
        surface.normals[voxels],
        np.repeat(np.arange(len(voxels)), counts),
        chosen.directions,
        np.sqrt(ALPHAS**2 + WIDENING * deviations**2),
    )
    seen = np.clip(lobes[REFERENCE, :, SEEN], 0.0, 1.0).astype(np.float64)
    trust = seen**TRUST
    fits = fit_by_likelihood(chosen.colours, chosen.offsets, lobes, trust)
    of_parts = np.zeros((PARTS, len(ALPHAS)))
    np.add.at(of_parts, spatial_parts(surface.positions[voxels]), fits.of_voxels.T)
    # A clipped observation is a bound alone, and says little.
    known = trust * (chosen.colours < 255).mean(axis=1)
    effective = float((known / np.repeat(counts, counts)).sum())
    clipped = 1.0 - float(known.sum()) / max(float(trust.sum()), 1e-9) if len(trust) else 0.0
    fewest = min(FEWEST_VOXELS, most / 4.0)
    found = identifiability(
        ALPHAS, of_parts, fits.log_prior, fits.matte, effective, clipped, least_gain, fewest
    )
    log_likelihood = of_parts.sum(axis=0) + fits.log_prior
    return GlossPosterior(
        alphas=ALPHAS,
        log_likelihood=log_likelihood - log_likelihood.max(),
        rho_s=fits.rho_s,
        rho_d=_albedos(surface, light, segments, voxels, fits.diffuse),
        probability=found.probability,
        alpha=math.exp(found.log_alpha),
        log_alpha_stddev=found.log_alpha_stddev,
        delta_log_likelihood=found.gain,
        effective_voxels=effective,
        is_identifiable=found.reason == "",
        reason=found.reason,
    )


def _albedos(
    surface: ObservedSurface,
    light: LightPyramid,
    segments: Sequence[NDArray[np.int64]],
    voxels: NDArray[np.int64],
    diffuse: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(S, K, 3) diffuse radiance over diffuse light, of each segment's voxels together."""
    arriving = np.maximum(mean_radiance(light, surface.normals[voxels])[:, RADIANCE], DARKEST)
    albedos = np.full((len(segments), len(diffuse), 3), np.nan)
    for row, segment in enumerate(segments):
        inside = np.isin(voxels, segment)
        if inside.any():
            albedos[row] = diffuse[:, inside].sum(axis=1) / arriving[inside].sum(axis=0)
    return albedos


def spatial_parts(positions: NDArray[np.float32]) -> NDArray[np.int64]:
    """Divide voxels in space: each group is halved at the median along its longest extent.

    Errors of different parts are nearly independent.

    Args:
        positions: (V, 3), metres.

    Returns:
        (V,) the part of each voxel, 0 to :data:`PARTS` - 1.
    """
    groups = [np.arange(len(positions))]
    for _ in range(HALVINGS):
        groups = [half for group in groups for half in _halves(positions, group)]
    parts = np.zeros(len(positions), np.int64)
    for part, group in enumerate(groups):
        parts[group] = part
    return parts


def _halves(
    positions: NDArray[np.float32], group: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The two halves of voxels with rising indices."""
    inside = positions[group]
    if len(group) == 0:
        return group, group
    longest = (inside.max(axis=0) - inside.min(axis=0)).argmax()
    order = np.argsort(inside[:, longest], kind="stable")
    middle = len(group) // 2
    return group[np.sort(order[:middle])], group[np.sort(order[middle:])]
