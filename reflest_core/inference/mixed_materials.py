# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Whether a surface that was taken for one material has two diffuse albedos, side by side.

The apparent albedos of voxels spread over the surface are divided in two (k-means, Lloyd 1982, in
Lab with lightness halved). Errors of shading change lightness gradually; two materials lie apart,
each with little scatter of its own, and neighbours are mostly of one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reflest_core.brdf.apparent_albedo import albedo_to_lab, apparent_albedo
from reflest_core.inference.light import SceneLight
from reflest_core.inference.transport.irradiance import weighted_radiance
from reflest_core.jit import compiled
from reflest_core.light.completion import RADIANCE

ROUNDS = 20
NEIGHBOURS = 6
FEWEST = 50
"""Voxels, with fewer of which nothing is said."""
APART, SCATTER = 12.0, 2.2
"""Distance of the two means in Lab, and over the RMS distance to them, from which they are two."""
SMALLEST = 0.025
"""Share of the voxels that the smaller has at least."""
TOGETHER = 0.9
"""Share of neighbours that are of the same, at least."""
OBSERVED = 0.5
"""Share of the difference in albedo that the observed colours show at least: the rest would be of
the light, whose completion may be wrong."""
DARK = 0.003
"""Added to a linear colour before its logarithm."""


@dataclass(frozen=True)
class TwoAlbedos:
    """The best division of a surface in two.

    Attributes:
        share: of the voxels, in the smaller part.
        distance: between the parts' means, in Lab with lightness halved.
        scatter: RMS distance of the voxels to their part's mean.
        observed: share of the parts' difference in log albedo that their colours have too.
        positions: (N, 3) of the voxels, metres.
        in_second: (N,) which part each is in.
    """

    share: float
    distance: float
    scatter: float
    observed: float
    positions: NDArray[np.float32]
    in_second: NDArray[np.bool_]

    @cached_property
    def together(self) -> float:
        """Share of neighbours in one part."""
        _, near = cKDTree(self.positions).query(self.positions, k=NEIGHBOURS + 1)
        return float((self.in_second[near[:, 1:]] == self.in_second[:, None]).mean())

    @property
    def is_mixed(self) -> bool:
        """Whether the parts are two materials; the neighbours, which take longest, come last."""
        return (
            self.share >= SMALLEST
            and self.distance >= max(APART, SCATTER * self.scatter)
            and self.observed >= OBSERVED
            and self.together >= TOGETHER
        )


def albedos_of_material(light: SceneLight, material_id: int) -> TwoAlbedos | None:
    """Divide a material by the albedos that its evidence has in the completed light.

    Args:
        light: of the scene.
        material_id: which one; KeyError where the light has no evidence of it.
    """
    evidence = light.evidence[material_id]
    irradiance = weighted_radiance(light.completed, evidence.incoming)[:, RADIANCE]
    return two_albedos(evidence.surface.positions[evidence.voxels], evidence.colours, irradiance)


def two_albedos(
    positions: NDArray[np.float32], colours: NDArray[np.float32], irradiance: NDArray[np.float32]
) -> TwoAlbedos | None:
    """Divide voxels by their apparent albedos.

    Args:
        positions: (N, 3) metres, spread over the surface.
        colours: (N, 3) diffuse colours, linear.
        irradiance: (N, 3) ``E / pi`` in the same units.

    Returns:
        The division; None where there are too few voxels, or one albedo.
    """
    if len(positions) < FEWEST:
        return None
    albedo = apparent_albedo(colours, irradiance)
    lab = albedo_to_lab(albedo)
    centred = lab - lab.mean(axis=0)
    axis = np.linalg.svd(centred, full_matrices=False)[2][0]
    in_second, means, scatter = _divided(lab, centred @ axis > 0.0)
    if in_second.all() or not in_second.any():
        return None
    share = float(in_second.mean())
    shown, differs = _log_step(colours, in_second), _log_step(albedo, in_second)
    return TwoAlbedos(
        min(share, 1.0 - share),
        float(np.linalg.norm(means[0] - means[1])),
        scatter,
        float(shown @ differs) / max(float(differs @ differs), 1e-9),
        positions,
        in_second,
    )


@compiled
def _divided(
    values: NDArray[np.float64], in_second: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], NDArray[np.float64], float]:
    """Lloyd's rounds from a division of ``values`` (N, 3), until nothing changes or one is empty.

    Returns which are in the second part, the parts' means (2, 3) and the RMS distance to them.
    """
    means, squares = np.zeros((2, 3)), 0.0
    is_second = in_second.copy()
    for _ in range(ROUNDS):
        means[:] = 0.0
        counts = np.zeros(2)
        for n in range(len(values)):
            part = 1 if is_second[n] else 0
            counts[part] += 1.0
            for c in range(3):
                means[part, c] += values[n, c]
        if counts.min() == 0.0:
            break
        for part in range(2):
            means[part] /= counts[part]
        squares, has_changed = 0.0, False
        for n in range(len(values)):
            first, second = 0.0, 0.0
            for c in range(3):
                first += (values[n, c] - means[0, c]) ** 2
                second += (values[n, c] - means[1, c]) ** 2
            nearest = second < first
            has_changed |= nearest != is_second[n]
            is_second[n] = nearest
            squares += min(first, second)
        if not has_changed:
            break
    return is_second, means, math.sqrt(squares / len(values))


def _log_step(colours: NDArray[np.floating], in_second: NDArray[np.bool_]) -> NDArray[np.float64]:
    """(3,) mean logarithm of the colours of the second part less that of the first."""
    logs = np.log(colours.astype(np.float64) + DARK)
    return np.asarray(logs[in_second].mean(axis=0) - logs[~in_second].mean(axis=0))
