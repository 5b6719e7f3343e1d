# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Measures of how hard a scene is, and the ones in which a scene is unusual."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.brdf.lab import luminance
from reflest_core.brdf.parameters import RHO_D, RHO_S
from reflest_core.light.light_map import ObservedLight
from reflest_core.light.octahedral import octahedral_solid_angles
from reflest_core.surface.coverage import hemisphere_coverage
from reflest_core.training.data.sample import Sample

UNUSUAL_SHARE = 0.1
"""A measure is out of the ordinary in the worst tenth of a split's scenes."""


@dataclass(frozen=True)
class Measure:
    """A measure of a scene.

    Attributes:
        name: Its name in records.
        is_bad_when_high: Whether large values are the hard ones.
        sentence: Template of ``value`` and of ``rank``, the share of scenes that are easier.
    """

    name: str
    is_bad_when_high: bool
    sentence: str


MEASURES = (
    Measure(
        "light_seen",
        False,
        "only {value:.0%} of the directions around were seen (more in {rank:.0%} of the scenes)",
    ),
    Measure(
        "light_clipped",
        True,
        "{value:.0%} of the light seen was overexposed (less in {rank:.0%} of the scenes)",
    ),
    Measure(
        "room_brightness",
        False,
        "the surroundings are dark, half of what was seen of them below {value:.3f} of the "
        "sensor's white (brighter in {rank:.0%} of the scenes)",
    ),
    Measure(
        "surface_clipped",
        True,
        "{value:.0%} of the surface's observations were overexposed (fewer in {rank:.0%} of the "
        "scenes)",
    ),
    Measure(
        "surface_brightness",
        False,
        "the surface is dark in the images, its median {value:.3f} of the sensor's white (brighter "
        "in {rank:.0%} of the scenes)",
    ),
    Measure(
        "view_coverage",
        False,
        "points were seen from only {value:.0%} of their directions (more in {rank:.0%} of the "
        "scenes)",
    ),
    Measure(
        "voxels",
        False,
        "only {value:.0f} voxels were observed (more in {rank:.0%} of the scenes)",
    ),
    Measure(
        "rho_s",
        False,
        "rho_s is {value:.3f}, so that there is hardly a highlight to estimate alpha from (larger "
        "in {rank:.0%} of the scenes)",
    ),
    Measure(
        "rho_d",
        False,
        "the material is dark, its rho_d {value:.3f} in the mean (brighter in {rank:.0%} of the "
        "scenes)",
    ),
)


def measured(sample: Sample) -> dict[str, float]:
    """The value of each of :data:`MEASURES`.

    Args:
        sample: A scene with its light.
    """
    surface, light = sample.surface, sample.surface.light
    assert light is not None
    observed = np.flatnonzero(surface.observation_counts > 0)
    brightness = luminance(srgb.decode(surface.colours / 255.0))
    return {
        "light_seen": light.seen_share,
        "light_clipped": _clipped_share(light),
        "room_brightness": _median_brightness(light),
        "surface_clipped": float((surface.colours == 255).any(axis=1).mean()),
        "surface_brightness": float(np.median(brightness)),
        "view_coverage": hemisphere_coverage(surface, observed),
        "voxels": float(len(observed)),
        "rho_s": float(sample.ward[RHO_S]),
        "rho_d": float(sample.ward[RHO_D].mean()),
    }


def unusual(values: dict[str, float], of_split: list[dict[str, float]]) -> list[str]:
    """Sentences about the measures in which a scene is among the worst tenth of its split.

    Args:
        values: The scene's measures.
        of_split: The measures of every scene of the split.
    """
    found = []
    for measure in MEASURES:
        value = values[measure.name]
        others = np.array([of[measure.name] for of in of_split])
        better = others < value if measure.is_bad_when_high else others > value
        rank = float(better.mean())
        if rank >= 1.0 - UNUSUAL_SHARE:
            found.append((rank, measure.sentence.format(value=value, rank=rank)))
    return [sentence for _, sentence in sorted(found, key=lambda pair: -pair[0])]


def _clipped_share(light: ObservedLight) -> float:
    """Share of what was seen of the sphere that was overexposed."""
    weights = _weights(light)
    return float((weights * light.any_clipped).sum() / max(float(weights.sum()), 1e-9))


def _median_brightness(light: ObservedLight) -> float:
    """Half of the solid angle that was seen has a lower luminance; 0 if nothing was seen."""
    weights = _weights(light).ravel()
    if not weights.any():
        return 0.0
    values = luminance(light.radiance.reshape(-1, 3).astype(np.float64))
    order = np.argsort(values)
    running = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(running, 0.5 * running[-1])])


def _weights(light: ObservedLight) -> NDArray[np.float32]:
    return np.asarray(light.coverage * octahedral_solid_angles(len(light.coverage)), np.float32)
