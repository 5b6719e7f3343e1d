# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""From a scan to its materials: segments, their common light, gloss groups, and stable ids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import rgb_to_lab
from reflest_core.inference.gloss_fit import EVIDENCE, GlossFit
from reflest_core.inference.joint_scene import JointScene, infer_jointly
from reflest_core.inference.transport.scene_occluders import SceneOccluders
from reflest_core.inference.transport.surface_irradiance import SurfaceSight, surface_irradiance
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES
from reflest_core.light.completion import LightPyramid, complete
from reflest_core.light.light_map import ObservedLight
from reflest_core.segmentation.adjacency import neighbour_pairs
from reflest_core.segmentation.features import LIGHTNESS
from reflest_core.segmentation.groups import Borders, gloss_groups
from reflest_core.segmentation.identity import MaterialIds
from reflest_core.segmentation.segments import COARSE, FINE, segment
from reflest_core.segmentation.statistics import voxel_colours
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.partition import Partition
from reflest_core.surface.selection import keep_voxels

GROWN = 1.3
"""The light is inferred from scratch again when the scan has so many times the voxels."""


@dataclass(frozen=True)
class SegmentedScene:
    """The materials of a scan and the light that they are in.

    Attributes:
        surface: V observed voxels, by rising key.
        partition: their keys to material ids.
        joint: the segments and their light.
        sight: what each voxel sees of the light.
        irradiance: (V, 3) ``E / pi`` under that light, linear.
        segment_ids: (S,) the material id of each segment.
    """

    surface: ObservedSurface
    partition: Partition
    joint: JointScene
    sight: SurfaceSight
    irradiance: NDArray[np.float32]
    segment_ids: NDArray[np.int64]


class Segmenter:
    """Divides a growing scan into materials, keyframe by keyframe.

    The same sequence of scans gives the same bits. Memory is bounded by the voxels of one keyframe.
    """

    def __init__(self) -> None:
        """Begin a scan; no id was given yet."""
        self._ids = MaterialIds()
        self._last: tuple[NDArray[np.int64], JointScene] | None = None
        self._began_with = 0

    def segment(self, surface: ObservedSurface, observed: ObservedLight) -> SegmentedScene:
        """Divide the observed voxels of a scan into materials.

        Args:
            surface: the scan, +z up, of which at least one voxel was observed.
            observed: the light as it was seen, or assumed.
        """
        surface = in_key_order(surface)
        colours = voxel_colours(surface.colours, surface.offsets)
        pairs = neighbour_pairs(surface.positions)
        occluders = SceneOccluders.of(surface.positions, surface.normals, colours.median)
        sight = SurfaceSight.of(surface.positions, surface.normals, occluders)
        keys = surface.voxel_keys

        def divided(light: LightPyramid, is_known: bool) -> NDArray[np.int64]:
            irradiance = surface_irradiance(light, sight)[:, :3]
            size = COARSE if is_known else FINE
            return segment(surface.positions, surface.normals, pairs, colours, irradiance, size)

        if self._last is None or len(keys) > GROWN * self._began_with:
            self._began_with = len(keys)
            fine = divided(complete(observed), is_known=False)
            self._last = keys, infer_jointly(surface, observed, fine, occluders)
        last_keys, last = self._last
        labels = divided(last.light.light, is_known=True)
        start = last.light.start(_counterparts(last_keys, last.labels, keys, labels))
        joint = infer_jointly(surface, observed, labels, occluders, start)
        self._last = keys, joint
        irradiance = surface_irradiance(joint.light.light, sight)[:, :3]
        groups = _groups(surface, pairs, joint)
        ids = self._ids.match(keys, groups[labels])
        return SegmentedScene(
            surface,
            Partition.of(surface, ids[groups[labels]]),
            joint,
            sight,
            irradiance,
            ids[groups],
        )


def in_key_order(surface: ObservedSurface) -> ObservedSurface:
    """Select the observed voxels by rising key: no result depends on the order of the store.

    Args:
        surface: V voxels.
    """
    observed = np.flatnonzero(surface.observation_counts > 0)
    order = observed[np.argsort(surface.voxel_keys[observed], kind="stable")]
    if len(order) == surface.voxel_count and (np.diff(order) == 1).all():
        return surface
    return keep_voxels(surface, order)


def _counterparts(
    last_keys: NDArray[np.int64],
    last_labels: NDArray[np.int64],
    keys: NDArray[np.int64],
    labels: NDArray[np.int64],
) -> NDArray[np.int64]:
    """(S,) the earlier segment with which each one has most voxels in common, -1 if with none."""
    place = np.minimum(np.searchsorted(last_keys, keys), len(last_keys) - 1)
    common = np.flatnonzero((last_keys[place] == keys) & (last_labels[place] >= 0))
    overlaps = np.zeros((int(labels.max()) + 1, int(last_labels.max()) + 1), np.int64)
    np.add.at(overlaps, (labels[common], last_labels[place[common]]), 1)
    return np.where(overlaps.any(axis=1), overlaps.argmax(axis=1), -1)


def _groups(
    surface: ObservedSurface,
    pairs: NDArray[np.int32],
    joint: JointScene,
) -> NDArray[np.int64]:
    """(S,) the material of each segment."""
    borders = Borders.of(joint.labels, pairs, surface.normals)
    log_likelihood = np.stack([_log_likelihood(fit) for fit in joint.gloss])
    lab = rgb_to_lab(np.clip(np.nan_to_num(joint.light.rho_d), 0.0, 1.0))
    lab[:, 0] *= LIGHTNESS
    sizes = np.bincount(joint.labels, minlength=len(lab))
    return gloss_groups(borders, sizes, log_likelihood, lab)


def _log_likelihood(fit: GlossFit | None) -> NDArray[np.float64]:
    """(K,) of a segment's observations; zeros where there is no fit."""
    if fit is None:
        return np.zeros(len(ROUGHNESSES))
    misfit = np.maximum(fit.misfit.astype(np.float64), 1e-3)
    return np.asarray(-EVIDENCE * float(fit.count.max()) * np.log(misfit))
