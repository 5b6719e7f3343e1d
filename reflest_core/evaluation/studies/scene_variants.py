# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The same scan of a scene estimated in other ways, to see what each part of the estimate buys."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reflest_core.estimation.estimator import Estimator, NoEstimate
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.evaluation.statistics.material_clouds import MATCHED_WITHIN
from reflest_core.inference.light import seen_light
from reflest_core.light.completion import RADIANCE, complete
from reflest_core.light.light_map import ObservedLight
from reflest_core.surface.partition import Partition
from reflest_core.surface.selection import keep_voxels
from reflest_core.viewer.lights import octahedral_light

TITLES = {
    "materials": "many materials in one light",
    "true_segments": "the same with the true segments",
    "true_light": "the same in the true light",
    "seen_light": "the same in the seen light, filled smoothly",
    "segments": "the same without gloss groups",
    "alone": "each material in its own light",
    "whole": "one material for the scan",
}
"""Names of the variants, and what they are called on a page."""
VARIANTS = tuple(TITLES)


def variants(
    estimator: Estimator,
    found: MaterialMap,
    truth: NDArray[np.void],
    light: NDArray[np.float32] | None,
) -> Iterator[tuple[str, MaterialMap]]:
    """Estimate a scan in all ways of :data:`TITLES`.

    Args:
        estimator: Of ``found``.
        found: The scan's materials, z up.
        truth: Points of the true surface, see :func:`.read_cloud`.
        light: (H, 2 H, 3) equirectangular, the true light in the scan's exposure; None leaves
            ``true_light`` out.

    Yields:
        The name of a variant, and the materials that it finds.
    """
    surface = found.surface
    yield "materials", found
    yield "whole", _with_partition(estimator, found, Partition.whole(surface))
    yield "alone", _each_alone(estimator, found)
    yield "true_segments", _with_partition(estimator, found, _true_partition(found, truth))
    if found.light is not None and found.light.joint is not None:
        labels = found.light.joint.labels.astype(np.int64)
        yield "segments", _with_partition(estimator, found, Partition.of(surface, labels + 1))
    filled = complete(seen_light(surface)).levels[0][..., RADIANCE]
    yield "seen_light", _in_light(estimator, found, filled)
    if light is not None:
        yield "true_light", _in_light(estimator, found, octahedral_light(light)[..., RADIANCE])


def _with_partition(estimator: Estimator, found: MaterialMap, partition: Partition) -> MaterialMap:
    return estimator.materials(found.surface, partition, found.stamp_ns, found.frame_id)


def _in_light(
    estimator: Estimator, found: MaterialMap, radiance: NDArray[np.float32]
) -> MaterialMap:
    """The same materials in light (N, N, 3) that is taken for known in all directions."""
    known = ObservedLight(
        radiance, np.ones(radiance.shape[:2], np.float32), np.zeros_like(radiance)
    )
    surface = dataclasses.replace(found.surface, light=known)
    return estimator.materials(surface, found.partition, found.stamp_ns, found.frame_id)


def _each_alone(estimator: Estimator, found: MaterialMap) -> MaterialMap:
    """The same materials, each estimated in light inferred from it alone."""
    rho_d, stddev = np.full_like(found.rho_d, np.nan), np.full_like(found.rho_d, np.nan)
    ids, materials = found.material_ids, []
    for material in found.materials:
        voxels = np.flatnonzero(ids == material.id)
        part = keep_voxels(found.surface, voxels)
        try:
            estimate = estimator.estimate(part, found.stamp_ns, found.frame_id)
        except NoEstimate:
            continue
        rho_d[voxels], stddev[voxels] = estimate.rho_d, estimate.rho_d_stddev
        materials.append(dataclasses.replace(material, estimate=estimate))
    return dataclasses.replace(found, materials=tuple(materials), rho_d=rho_d, rho_d_stddev=stddev)


def _true_partition(found: MaterialMap, truth: NDArray[np.void]) -> Partition:
    """The scan divided by the truth; what lies far from every true point is one more."""
    places = np.stack([truth[axis] for axis in "xyz"], axis=1)
    distance, nearest = cKDTree(places).query(found.surface.positions)
    true_ids = truth["material_id"].astype(np.int64)
    ids = np.where(distance <= MATCHED_WITHIN, 1 + true_ids[nearest], 2 + true_ids.max())
    return Partition.of(found.surface, ids)
