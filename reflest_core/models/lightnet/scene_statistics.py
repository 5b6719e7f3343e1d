# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light and material as inferred, in numbers of order 1 for the network."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss.gloss_fit import SURE, GlossFit
from reflest_core.inference.light_from_shading import InferredLight
from reflest_core.inference.material import Explanation
from reflest_core.inference.material_fit import MaterialFit
from reflest_core.inference.transport.irradiance import DARKEST, weighted_radiance
from reflest_core.inference.transport.reflected_detail import DETAIL_STATISTICS
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES
from reflest_core.light.completion import RADIANCE, SEEN
from reflest_core.light.octahedral import octahedral_solid_angles
from reflest_core.models.lightnet.normal_bands import BANDS, NormalBands
from reflest_core.surface.observed_surface import ObservedSurface

CHANNEL_STATISTICS, STATISTICS = 42 + 3 * BANDS, 79 + 2 * BANDS + DETAIL_STATISTICS
"""How many numbers there are of a colour channel, and of all channels."""
LEAST = 0.01
"""Added before a logarithm of a ratio or an albedo."""
FURTHEST = 8.0
"""Greatest size of a number that is passed on."""
_QUANTILES = (0.1, 0.5, 0.9)
_PROBED = (0, 3, 7)
"""Roughnesses at which the seen share of the lobes' light enters."""

Array = NDArray[np.float32]


@dataclass(frozen=True)
class SceneStatistics:
    """Numbers of a scene.

    Attributes:
        of_channels: (3, C) float32, by colour channel.
        of_all: (S,) float32, of all three.
    """

    of_channels: Array
    of_all: Array


def scene_statistics(found: Explanation) -> SceneStatistics:
    """Gather numbers of a material's explanation; none depends on where +x points.

    Args:
        found: The material in the light of its scene.
    """
    surface = found.surface
    filled, whole = (
        weighted_radiance(light, found.incoming) for light in (found.filled, found.light)
    )
    lights = [np.maximum(light[:, RADIANCE], DARKEST) for light in (filled, whole)]
    by_fill, by_whole = (_log(found.colours / light) for light in lights)
    clipped = (found.colours >= 1.0).astype(np.float32)
    bands = NormalBands.of(found.normals, by_fill, by_whole, clipped, filled[:, SEEN])
    of_channels = np.concatenate(
        [
            *[_of_light(light) for light in found.inferred],
            _of_ratios(by_fill, by_whole),
            _of_strengths(found.colours, *lights),
            bands.of_channels,
            _of_views(found),
            _of_images(surface),
            _log(found.material.albedo.T),
            _log(found.material.weight @ found.material.albedo)[:, None],
        ],
        axis=1,
    )
    of_all = np.concatenate(
        [
            _of_roughness(found.material),
            _of_roughness(found.gloss),
            _of_gloss(found.gloss),
            _of_coverage(found, whole),
            bands.of_all,
            _of_scan(surface, found),
            found.detail,
        ]
    )
    return SceneStatistics(_bounded(of_channels), _bounded(of_all))


def _of_light(light: InferredLight) -> Array:
    """(3, 4): the albedo, how sure it is, how well it fits, and the mean of unseen light."""
    return np.stack(
        [
            _log(light.albedo),
            np.log(light.deviation + np.float32(1e-3)),
            10.0 * light.misfit,
            _log(light.unseen.mean(axis=0)),
        ],
        axis=1,
    )


def _of_ratios(by_fill: Array, by_whole: Array) -> Array:
    """(3, 6): logarithms of colour over light, before and after completion, over the surface."""
    quantiles = [_quantiles(ratios, _QUANTILES) for ratios in (by_fill, by_whole)]
    return np.asarray(np.concatenate(quantiles).T, np.float32)


def _of_strengths(colours: Array, filled: Array, whole: Array) -> Array:
    """(3, 8): how bright the surface is, and its light before and after completion."""
    return np.stack(
        [
            *_quantiles(np.log(colours + LEAST), _QUANTILES),
            _log(whole / filled).mean(axis=0),
            _log(whole / filled).std(axis=0),
            np.log(filled + LEAST).mean(axis=0),
            np.log(filled).std(axis=0),
            np.log(whole).std(axis=0),
        ],
        axis=1,
    )


def _of_views(found: Explanation) -> Array:
    """(3, 5): how much and how unevenly a voxel's colour changes with the view."""
    sample = found.sample
    grid = sample.spread(sample.colours)
    is_seen = sample.spread(np.ones(len(sample.voxel_of), np.float32))[..., None]
    count = np.maximum(is_seen.sum(axis=1), 1.0)
    mean = grid.sum(axis=1) / count
    deviation = np.sqrt((is_seen * (grid - mean[:, None]) ** 2).sum(axis=1) / count)
    spread = deviation / (mean + LEAST)
    highest = grid.max(axis=1) / (mean + LEAST)
    return np.stack(
        [
            *_quantiles(spread, (0.5, 0.9)),
            *_log(_quantiles(highest, (0.5, 0.95))),
            sample.clipped.mean(axis=0),
        ],
        axis=1,
    )


def _of_images(surface: ObservedSurface) -> Array:
    """(3, 2): logarithms of the mean foreground and background colour, F and B."""
    observed = np.flatnonzero(surface.is_observing)
    colours = np.stack([surface.view_foreground[observed], surface.view_background[observed]])
    known = np.where(np.isfinite(colours), colours, 0.0)
    mean = known.sum(axis=1) / np.maximum(np.isfinite(colours).sum(axis=1), 1)
    return np.asarray(np.log(mean.T / 255.0 + 5 * LEAST), np.float32)


def _of_roughness(material: MaterialFit | GlossFit) -> Array:
    """(2 K + 4,): by roughness ``rho_s`` and misfit; of all, the best misfit and a mean."""
    best = max(float(material.misfit.min()), 1e-4)
    return np.concatenate(
        [
            material.gloss,
            10.0 * np.log(material.misfit / best + 1e-9),
            [np.log(best), material.weight @ material.gloss],
            _mean_and_spread(material.weight),
        ]
    ).astype(np.float32)


def _of_gloss(gloss: GlossFit) -> Array:
    """(2 K + 5,): how sure each ``rho_s`` is, from how much, and how likely each roughness is."""
    return np.concatenate(
        [
            np.log(gloss.deviation) + 4.0,
            np.log(gloss.count[list(_PROBED)] + 1.0) - 4.0,
            gloss.weight,
            _mean_and_spread(gloss.weight_by(SURE)),
        ]
    ).astype(np.float32)


def _mean_and_spread(weight: Array) -> Array:
    """(2,), of the roughness, in tenths."""
    roughness = np.array(ROUGHNESSES, np.float32)
    mean = weight @ roughness
    return np.array([10.0 * mean, 10.0 * np.sqrt(weight @ (roughness - mean) ** 2)], np.float32)


def _of_coverage(found: Explanation, whole: Array) -> Array:
    """(12,): seen and clipped shares of the sphere, of diffuse light and of some lobes' light."""
    fine = found.filled.levels[0]
    angles = octahedral_solid_angles(len(fine))[..., None] / (4.0 * np.pi)
    diffuse = whole[:, 3:]
    lobes = found.lobes[:, _PROBED, 3:].mean(axis=0)
    return np.concatenate(
        [
            (fine[..., 3:] * angles).sum(axis=(0, 1)),
            diffuse.mean(axis=0),
            diffuse.std(axis=0),
            lobes.ravel(),
        ]
    )


def _of_scan(surface: ObservedSurface, found: Explanation) -> Array:
    """(6,): how much was seen, from how many views, and how steeply from above."""
    sample = found.sample
    counts = surface.observation_counts[sample.voxels]
    cosine = np.einsum("ij,ij->i", sample.directions, sample.normals[sample.voxel_of])
    return np.array(
        [
            np.log(surface.observing_views) - 3.0,
            np.log(counts.mean()) - 2.0,
            sample.directions[:, 2].mean(),
            sample.directions[:, 2].std(),
            cosine.mean(),
            sample.normals[:, 2].mean(),
        ],
        np.float32,
    )


def _quantiles(values: Array, shares: tuple[float, ...]) -> NDArray[np.float64]:
    """(Q, C) of each column of (N, C), as ``np.quantile`` gives them, in a third of its time."""
    ordered = np.sort(values, axis=0)
    places = np.array(shares) * (len(values) - 1)
    below = places.astype(np.int64)
    share = (places - below)[:, None]
    low, high = ordered[below], ordered[np.minimum(below + 1, len(values) - 1)]
    step = high - low
    return np.asarray(np.where(share < 0.5, low + step * share, high - step * (1.0 - share)))


def _log(ratio: NDArray[np.floating]) -> Array:
    return np.asarray(np.log(ratio + LEAST), np.float32)


def _bounded(values: NDArray[np.floating]) -> Array:
    return np.asarray(np.clip(values, -FURTHEST, FURTHEST), np.float32)
