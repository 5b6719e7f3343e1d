# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The materials of everything that was scanned, and the light that they share."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.reliability import grouped_warnings
from reflest_core.inference.gloss.normal_quality import normal_deviations
from reflest_core.inference.light import SceneLight
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.partition import UNASSIGNED, Partition

NEAREST_VOXELS = 32
"""Voxels whose most frequent material is that of a point."""
MOST_MATERIALS = 256
"""Materials of a map at most, the largest; the message is bounded by the same number."""


@dataclass(frozen=True)
class MaterialEstimate:
    """One material of a scan; its fields are those of ``reflest_ros/msg/Material``.

    Attributes:
        id: stable from keyframe to keyframe, never used again within a scan.
        estimate: the BRDF.
        centroid: (3,) mean position of its voxels, world frame, metres.
        extent: (3,) edges of their axis-aligned bounding box, metres.
        area: of its surface, square metres.
        voxel_count: voxels of the material.
        photometric_error: RMS difference between what was observed and the estimate rendered in
            the published light, in linear colour over the material's mean; NaN where unknown.
    """

    id: int
    estimate: BrdfEstimate
    centroid: tuple[float, float, float]
    extent: tuple[float, float, float]
    area: float
    voxel_count: int
    photometric_error: float = math.nan

    def to_json(self) -> dict[str, Any]:
        """Message field names to JSON values; NaN becomes null."""
        error = self.photometric_error
        return {
            "id": self.id,
            "estimate": self.estimate.to_json(),
            "centroid": list(self.centroid),
            "extent": list(self.extent),
            "area": self.area,
            "voxel_count": self.voxel_count,
            "photometric_error": None if math.isnan(error) else error,
        }


@dataclass(frozen=True)
class MaterialMap:
    """All materials of a scan at one keyframe.

    Attributes:
        stamp_ns: stamp of the keyframe's image.
        frame_id: camera frame of that image.
        surface: the V voxels that the map is of, world frame.
        partition: their keys to material ids.
        materials: estimates in falling order of area, at most :data:`MOST_MATERIALS`.
        rho_d: (V, 3) float32, each voxel's diffuse albedo, linear sRGB; NaN where unknown.
        rho_d_stddev: (V, 3) float32, its standard deviation; NaN where unknown.
        light: inferred from all materials; None from networks that see no light.
        world_frame_id: frame of the surface, "" where unknown.
        seconds: that the stages took: ``segmentation`` with the joint light, ``light`` (the rest of
            it) and ``materials``.
    """

    stamp_ns: int
    frame_id: str
    surface: ObservedSurface
    partition: Partition
    materials: tuple[MaterialEstimate, ...]
    rho_d: NDArray[np.float32]
    rho_d_stddev: NDArray[np.float32]
    light: SceneLight | None = None
    world_frame_id: str = ""
    seconds: Mapping[str, float] = field(default_factory=dict, compare=False)

    @property
    def segment_count(self) -> int:
        """Segments that the materials consist of."""
        joint = None if self.light is None else self.light.joint
        return len(self.materials) if joint is None else len(joint.gloss)

    @property
    def light_condition(self) -> float:
        """Condition number of the joint solution for the light; NaN where there is none."""
        joint = None if self.light is None else self.light.joint
        return math.nan if joint is None else joint.light.condition

    @property
    def material_ids(self) -> NDArray[np.uint32]:
        """(V,) id of each voxel's material."""
        return self.partition.ids_of(self.surface.voxel_keys)

    @cached_property
    def normal_stddev(self) -> NDArray[np.float32]:
        """(V,) standard deviation of each voxel's normal about each tangent axis, radians."""
        surface = self.surface
        return normal_deviations(surface.positions, surface.normals, surface.neighbour_radius)

    def material(self, material_id: int) -> MaterialEstimate | None:
        """Find a material.

        Args:
            material_id: its id.

        Returns:
            The material, None where the map has none of this id.
        """
        return next((found for found in self.materials if found.id == material_id), None)

    def near(self, point: NDArray[np.float64]) -> MaterialEstimate | None:
        """Find the material at a point.

        Args:
            point: (3,) on the surface or near it, world frame, metres.

        Returns:
            The material that most of the voxels nearest to it are of, among those with an
            estimate; None where there is none.
        """
        if not self.materials:
            return None
        known = np.array([found.id for found in self.materials])
        ids = self.material_ids
        return self.material(
            nearest_material(
                self.surface.positions,
                np.where(np.isin(ids, known), ids, UNASSIGNED),
                point - self.surface.origin,
            )
        )

    def warnings(self) -> dict[str, list[int]]:
        """Return each kind of warning once, see :func:`.grouped_warnings`."""
        return grouped_warnings(
            (found.id, sentence)
            for found in self.materials
            for sentence in found.estimate.status_text.split("; ")
            if sentence
        )

    def of_voxels(self, name: str) -> NDArray[np.float32]:
        """Spread a number of the materials' estimates over the voxels.

        Args:
            name: a scalar field of :class:`BrdfEstimate`, such as ``"alpha"``.

        Returns:
            (V,) float32; NaN for voxels of no material.
        """
        values = np.full(self.surface.voxel_count, np.nan, np.float32)
        ids = self.material_ids
        for found in self.materials:
            values[ids == found.id] = getattr(found.estimate, name)
        return values


def nearest_material(
    positions: NDArray[np.float32], ids: NDArray[np.integer], point: NDArray[np.float64]
) -> int:
    """Find the id that most of the voxels nearest to a point have.

    Args:
        positions: (V, 3) metres.
        ids: (V,) id of each voxel's material; :data:`.UNASSIGNED` for voxels that do not count.
        point: (3,) in the same frame.

    Returns:
        The id, of equally frequent ones the least; :data:`.UNASSIGNED` where no voxel counts.
    """
    voxels = np.flatnonzero(ids != UNASSIGNED)
    if not len(voxels):
        return UNASSIGNED
    away = np.linalg.norm(positions[voxels].astype(np.float64) - point, axis=1)
    nearest = voxels[np.argsort(away, kind="stable")[:NEAREST_VOXELS]]
    return int(np.bincount(ids[nearest]).argmax())
