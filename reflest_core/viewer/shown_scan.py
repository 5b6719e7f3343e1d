# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the viewer draws: a triangle mesh whose vertices know their voxels and materials."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reflest_core.brdf import srgb
from reflest_core.estimation.material_map import MaterialEstimate, MaterialMap
from reflest_core.export.bake import interpolated
from reflest_core.export.scanned_mesh import mesh_of_voxels, scanned_mesh
from reflest_core.export.triangle_mesh import TriangleMesh
from reflest_core.fusion.scan import Scan
from reflest_core.rendering.voxel_colours import observed_colours
from reflest_core.surface.coverage import RINGS, SECTORS, seen_cells
from reflest_core.surface.observed_surface import ObservedSurface

FACES = 120_000
"""Triangles that a laptop's browser turns smoothly."""
NORMALS_WIDTH, SAME_SIDE = 1.2, 0.5
"""Of the Gaussian that normals are averaged by, in voxels; their least cosine to the mesh's."""
NO_MATERIAL = 0
"""Id of what belongs to none."""
PARALLEL = 1e-12
"""Of a determinant below which a ray runs along a triangle."""


@dataclass(frozen=True)
class ShownScan:
    """A mesh in the coordinates of the scan, and the material map that it shows.

    Attributes:
        vertices: (N, 3) float32, metres.
        normals: (N, 3) float32, unit, outward.
        faces: (F, 3) int32.
        voxel_of: (N,) int64, the nearest voxel of the map.
        found: the map.
        up: direction that points up in the world frame.
        voxel_size: edge of a voxel, metres.
        view_stamps: (W,) int64, nanoseconds, when each view of the map's surface was taken; empty
            where that is not known.
        light: (L, L, 5) float32, the light of the scan as the finest level of
            :class:`.LightPyramid`, turned so that up is +z; None where it is not known.
        voxel_colours: (V, 3) uint8 sRGB, the mean that the views saw of each of the map's voxels,
            where its surface holds no observations; None where that is not known.
    """

    vertices: NDArray[np.float32]
    normals: NDArray[np.float32]
    faces: NDArray[np.int32]
    voxel_of: NDArray[np.int64]
    found: MaterialMap
    up: tuple[float, float, float]
    voxel_size: float
    view_stamps: NDArray[np.int64]
    light: NDArray[np.float32] | None = None
    voxel_colours: NDArray[np.uint8] | None = None

    @staticmethod
    def of(
        scan: Scan, found: MaterialMap, up: tuple[float, float, float], faces: int = FACES
    ) -> ShownScan:
        """Extract the mesh of a scan.

        Args:
            scan: what was fused.
            found: its materials.
            up: direction that points up in the world frame.
            faces: the mesh is decimated to about so many.

        Raises:
            ExportError: Nothing was scanned, or a package of the extra ``asset`` is missing.
        """
        size = scan.fusion.voxel_size
        stamps = scan.views.stamps[: scan.views.count].copy()
        light = None if found.light is None else found.light.completed.levels[0]
        return _shown(scanned_mesh(scan, faces, up=up), found, up, size, stamps, light)

    @staticmethod
    def of_voxels(
        found: MaterialMap,
        up: tuple[float, float, float],
        voxel_size: float,
        light: NDArray[np.float32] | None,
        voxel_colours: NDArray[np.uint8] | None = None,
    ) -> ShownScan:
        """Reconstruct the mesh from the map's voxels, where no volume is at hand.

        Args:
            found: the materials.
            up: direction that points up in the world frame.
            voxel_size: between neighbours, metres.
            light: see :attr:`light`.
            voxel_colours: see :attr:`voxel_colours`.

        Raises:
            ExportError: There is no surface, or a package of the extra ``asset`` is missing.
        """
        surface = found.surface
        mesh = mesh_of_voxels(surface.positions, surface.normals, voxel_size, FACES, up=up)
        return _shown(mesh, found, up, voxel_size, np.zeros(0, np.int64), light, voxel_colours)

    @property
    def has_observations(self) -> bool:
        """Whether the map's surface still holds what the views saw."""
        return len(self.found.surface.colours) > 0

    @property
    def has_colours(self) -> bool:
        """Whether :attr:`observed` is known."""
        return self.has_observations or self.voxel_colours is not None

    @cached_property
    def material_ids(self) -> NDArray[np.int64]:
        """(N,) id of each vertex' material; :data:`NO_MATERIAL` without an estimate."""
        known = [one.id for one in self.found.materials]
        ids = self.found.material_ids.astype(np.int64)
        return np.where(np.isin(ids, known), ids, NO_MATERIAL)[self.voxel_of]

    @cached_property
    def rho_d(self) -> NDArray[np.float32]:
        """(N, 3) albedo, between the nearest voxels of the vertex' material; NaN where unknown."""
        width = 0.7 * self.voxel_size
        surface, labels = self.found.surface, self.found.material_ids.astype(np.int64)
        found = interpolated(
            self.vertices,
            labels[self.voxel_of].astype(np.int32),
            surface.positions,
            labels.astype(np.int32),
            self.found.rho_d,
            width,
        )
        return np.where(self.material_ids[:, None] == NO_MATERIAL, np.float32(np.nan), found)

    @cached_property
    def observed(self) -> NDArray[np.uint8]:
        """(N, 3) sRGB, the mean that the views saw, between the nearest voxels."""
        surface = self.found.surface
        colours = self.voxel_colours
        linear = srgb.LINEAR[observed_colours(surface) if colours is None else colours]
        one = np.zeros(surface.voxel_count, np.int32)
        smooth = interpolated(
            self.vertices,
            one[self.voxel_of],
            surface.positions,
            one,
            linear,
            0.7 * self.voxel_size,
        )
        return np.asarray(np.rint(255 * srgb.encode(smooth)), np.uint8)

    @cached_property
    def coverage(self) -> NDArray[np.float32]:
        """(N,) share of the directions from which the voxel can be seen that were used."""
        voxels = np.arange(self.found.surface.voxel_count)
        cells = seen_cells(self.found.surface, voxels)
        shares = cells.sum(axis=(1, 2)) / (RINGS * SECTORS)
        return np.asarray(shares[self.voxel_of], np.float32)

    @cached_property
    def first_seen(self) -> NDArray[np.int64]:
        """(N,) nanoseconds, when a view first saw the vertex' voxel; 0 where that is not known."""
        surface = self.found.surface
        counts = surface.observation_counts
        first = np.zeros(surface.voxel_count, np.int64)
        if len(self.view_stamps) and counts.any():
            stamps = self.view_stamps[surface.view_indices]
            # reduceat needs a row for each start: voxels without observations are left out.
            first[counts > 0] = np.minimum.reduceat(stamps, surface.offsets[:-1][counts > 0])
        return first[self.voxel_of]

    def of_materials(self, name: str) -> NDArray[np.float32]:
        """Spread a number of the materials' estimates over the vertices.

        Args:
            name: a scalar field of :class:`.BrdfEstimate`.

        Returns:
            (N,) float32; NaN where there is no estimate.
        """
        values = np.full(len(self.vertices), np.nan, np.float32)
        for one in self.found.materials:
            values[self.material_ids == one.id] = getattr(one.estimate, name)
        return values

    def material_at(self, vertex: int) -> MaterialEstimate | None:
        """The material of a vertex.

        Args:
            vertex: its index.
        """
        return self.found.material(int(self.material_ids[vertex]))

    def vertex_under(
        self, origin: NDArray[np.floating], direction: NDArray[np.floating]
    ) -> tuple[int, NDArray[np.float64]] | None:
        """Find where a ray first meets the surface (Moeller and Trumbore 1997).

        Args:
            origin: (3,) world frame, metres.
            direction: (3,) any length but 0.

        Returns:
            The nearest vertex there and the (3,) point; None where the ray meets nothing.
        """
        origin, direction = np.asarray(origin, np.float64), np.asarray(direction, np.float64)
        corner, second, third = (
            self.vertices[self.faces[:, k]].astype(np.float64) for k in range(3)
        )
        edge, other = second - corner, third - corner
        across = np.cross(direction, other)
        determinant = np.einsum("fc,fc->f", edge, across)
        is_flat = np.abs(determinant) < PARALLEL
        scale = 1.0 / np.where(is_flat, 1.0, determinant)
        away = origin - corner
        u = np.einsum("fc,fc->f", away, across) * scale
        turned = np.cross(away, edge)
        v = turned @ direction * scale
        distance = np.einsum("fc,fc->f", other, turned) * scale
        is_hit = ~is_flat & (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 0)
        if not is_hit.any():
            return None
        face = int(np.argmin(np.where(is_hit, distance, np.inf)))
        point = origin + distance[face] * direction
        corners = self.faces[face]
        nearest = np.linalg.norm(self.vertices[corners] - point, axis=1).argmin()
        return int(corners[nearest]), point


def _shown(
    mesh: TriangleMesh,
    found: MaterialMap,
    up: tuple[float, float, float],
    voxel_size: float,
    stamps: NDArray[np.int64],
    light: NDArray[np.float32] | None,
    voxel_colours: NDArray[np.uint8] | None = None,
) -> ShownScan:
    _, near = cKDTree(found.surface.positions).query(mesh.vertices)
    return ShownScan(
        mesh.vertices,
        _smooth_normals(mesh, found.surface, voxel_size),
        mesh.faces,
        near.astype(np.int64),
        found,
        up,
        voxel_size,
        stamps,
        light,
        voxel_colours,
    )


def _smooth_normals(
    mesh: TriangleMesh, surface: ObservedSurface, voxel_size: float
) -> NDArray[np.float32]:
    """(N, 3) between those of near voxels, which the estimator smoothed; at edges the mesh's."""
    one, own = np.zeros(len(mesh.vertices), np.int32), mesh.vertex_normals
    label = np.zeros(surface.voxel_count, np.int32)
    mean = interpolated(
        mesh.vertices, one, surface.positions, label, surface.normals, NORMALS_WIDTH * voxel_size
    )
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    smooth = mean / np.maximum(length, 1e-6)
    is_alike = (length > 0.5) & (np.einsum("nc,nc->n", smooth, own)[:, None] > SAME_SIDE)
    return np.where(is_alike, smooth, own).astype(np.float32)
