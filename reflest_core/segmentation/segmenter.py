# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""From a scan to its materials: segments, their common light, gloss groups, and stable ids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.apparent_albedo import LIGHTNESS
from reflest_core.brdf.lab import rgb_to_lab
from reflest_core.inference.gloss.gloss_fit import EVIDENCE, GlossFit
from reflest_core.inference.joint_light import JointLight
from reflest_core.inference.joint_scene import JointScene, infer_jointly
from reflest_core.inference.transport.scene_occluders import SceneOccluders
from reflest_core.inference.transport.surface_irradiance import SurfaceSight, surface_irradiance
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES
from reflest_core.light.completion import RADIANCE, LightPyramid, complete
from reflest_core.light.light_map import ObservedLight
from reflest_core.segmentation.adjacency import neighbour_pairs
from reflest_core.segmentation.groups import Borders, gloss_groups
from reflest_core.segmentation.identity import MaterialIds
from reflest_core.segmentation.segments import COARSE, FINE, SegmentSize, segment
from reflest_core.segmentation.statistics import voxel_colours
from reflest_core.surface.material_ids import GivenIds
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.partition import Partition
from reflest_core.surface.selection import keep_voxels


@dataclass(frozen=True)
class SegmentedScene:
    """The materials of a scan and the light that they are in.

    Attributes:
        surface: V observed voxels, by rising key.
        partition: their keys to material ids.
        joint: the segments and their light.
        sight: what each voxel sees of the light.
        irradiance: (V, 3) ``E / pi`` under that light, linear.
    """

    surface: ObservedSurface
    partition: Partition
    joint: JointScene
    sight: SurfaceSight
    irradiance: NDArray[np.float32]

    def bases(self) -> dict[int, tuple[float, ...]]:
        """What is known of each material, by id: voxels, observations, mean irradiance (3)."""
        ids = self.partition.ids_of(self.surface.voxel_keys)
        counts = self.surface.observation_counts
        found = {}
        for material_id in self.partition.ids:
            voxels = np.flatnonzero(ids == material_id)
            light = self.irradiance[voxels].mean(axis=0, dtype=np.float64)
            found[material_id] = (float(len(voxels)), float(counts[voxels].sum()), *light.tolist())
        return found


class Segmenter:
    """Divides a growing scan into materials, keyframe by keyframe.

    The same sequence of scans gives the same bits. Memory is bounded by the voxels of one keyframe.
    """

    def __init__(self, given: GivenIds | None = None) -> None:
        """Begin a scan, or continue one.

        Args:
            given: ids that a scan's voxels have already.
        """
        self._ids = MaterialIds() if given is None else MaterialIds(given)
        self._last = np.zeros(0, np.int64), np.zeros(0, np.int64)
        self._light: JointLight | None = None

    @property
    def given_ids(self) -> GivenIds:
        """Ids of the last keyframe's voxels; may be read from any thread."""
        return self._ids.given

    def segment(self, surface: ObservedSurface, observed: ObservedLight) -> SegmentedScene:
        """Divide the observed voxels of a scan into materials.

        Args:
            surface: the scan, +z up, of which at least one voxel was observed.
            observed: the light as it was seen, or assumed.
        """
        surface = in_key_order(surface)
        colours = voxel_colours(surface.colours, surface.offsets)
        pairs = neighbour_pairs(surface.positions, surface.neighbour_radius)
        occluders = SceneOccluders.of(surface.positions, surface.normals, colours.median)
        sight = SurfaceSight.of(surface.positions, surface.normals, occluders)
        keys = surface.voxel_keys

        before, old_ids = self._before(keys)

        def divided(light: LightPyramid, size: SegmentSize) -> NDArray[np.int64]:
            irradiance = surface_irradiance(light, sight)[:, RADIANCE]
            places = surface.positions, surface.normals, pairs
            return segment(*places, colours, irradiance, size, before)

        known = self._light
        if known is None:
            fine = divided(complete(observed), FINE)
            known = infer_jointly(surface, observed, fine, occluders).light
        labels = divided(known.light, COARSE)
        joint = infer_jointly(surface, observed, labels, occluders, known)
        self._last, self._light = (keys, labels), joint.light
        irradiance = surface_irradiance(joint.light.light, sight)[:, RADIANCE]
        groups = _groups(surface, pairs, joint, _majority(labels, old_ids))
        ids = self._ids.match(keys, groups[labels])
        partition = Partition.of(surface, ids[groups[labels]])
        return SegmentedScene(surface, partition, joint, sight, irradiance)

    def _before(self, keys: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """(V,) the segment and (V,) the id that each voxel had, -1 for new ones."""
        given = self._ids.given
        ids = _looked_up(given.keys, given.ids, keys)
        return _looked_up(*self._last, keys), ids


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


def _looked_up(
    keys: NDArray[np.int64], values: NDArray[np.int64], wanted: NDArray[np.int64]
) -> NDArray[np.int64]:
    """The values of ``wanted`` keys by rising ``keys``; -1 for those that are not there."""
    if not len(keys):
        return np.full(len(wanted), -1)
    place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.where(keys[place] == wanted, values[place], -1)


def _majority(labels: NDArray[np.int64], ids: NDArray[np.int64]) -> NDArray[np.int64]:
    """(S,) the id that most voxels of each segment had; -1 where none had one."""
    found = np.full(int(labels.max()) + 1, -1)
    has_id = ids >= 0
    codes, counts = np.unique(
        np.stack([labels[has_id], ids[has_id]], axis=1), axis=0, return_counts=True
    )
    for row in np.argsort(counts, kind="stable"):
        found[codes[row, 0]] = codes[row, 1]
    return found


def _groups(
    surface: ObservedSurface,
    pairs: NDArray[np.int32],
    joint: JointScene,
    before: NDArray[np.int64],
) -> NDArray[np.int64]:
    """(S,) the material of each segment."""
    borders = Borders.of(joint.labels, pairs, surface.normals)
    log_likelihood = np.stack([_log_likelihood(fit) for fit in joint.gloss])
    lab = rgb_to_lab(np.clip(np.nan_to_num(joint.light.rho_d), 0.0, 1.0))
    lab[:, 0] *= LIGHTNESS
    sizes = np.bincount(joint.labels, minlength=len(lab))
    return gloss_groups(borders, sizes, log_likelihood, lab, before)


def _log_likelihood(fit: GlossFit | None) -> NDArray[np.float64]:
    """(K,) of a segment's observations; zeros where there is no fit."""
    if fit is None:
        return np.zeros(len(ROUGHNESSES))
    misfit = np.maximum(fit.misfit.astype(np.float64), 1e-3)
    return np.asarray(-EVIDENCE * float(fit.count.max()) * np.log(misfit))
