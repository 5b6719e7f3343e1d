# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan and its materials as an asset."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reflest_core.environment.environment_map import (
    EnvironmentMap,
    environment_map,
    from_octahedral,
)
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.export.asset import Asset, AssetMaterial, AssetMesh
from reflest_core.export.atlas import Atlas, unwrapped
from reflest_core.export.bake import covered_texels, filled, interpolated
from reflest_core.export.errors import ExportError
from reflest_core.export.material_seams import cut_at_seams
from reflest_core.export.microfacet_material import MicrofacetMaterial, base_colour
from reflest_core.export.scanned_mesh import scanned_mesh
from reflest_core.export.triangle_mesh import TriangleMesh, decimated
from reflest_core.fusion.scan import Scan
from reflest_core.surface.upright import rotation_to_z, upright

FACES = 20_000
SIZES = (256, 512, 1024, 2048, 4096)
"""Texture sizes to choose from."""
TEXELS_PER_VOXEL = 2.0
"""Along each direction, where the largest texture allows that."""
VOTERS = 9
"""Voxels that vote for the material of a place."""
TURNED = 6.0
"""Voxels that a voxel counts as farther for each unit that its normal differs."""
FILLED_BEYOND = 3.5
"""A place whose nearest voxel is farther than so many voxels, so counted, was filled in."""
LEVEL = 0.8
"""Cosine between a normal and up from which a place or a voxel lies level, as a table does."""
OVERHANG = 15.0
"""A voxel overhangs what was filled in within so many voxels, beside it and below."""
ABOVE = 8
"""Voxels that are asked whether they lie above a place."""
SURPLUS = 1.2
"""So many faces less for each that cuts add too much; the larger faces get cuts, too."""
UNKNOWN = np.float32(-1.0)
"""A standard deviation that is not known, in vertex attributes."""


@dataclass(frozen=True)
class AssetSettings:
    """How the surface is written.

    Attributes:
        faces: The mesh is decimated to about so many.
        texture_size: Texels along each side; 0 chooses two texels for each voxel.
        is_watertight: Close the surface where nothing was scanned.
        up: Up in the scan's world frame.
        with_light: Whether the scan's light goes with the surface, where the format has one.
    """

    faces: int = FACES
    texture_size: int = 0
    is_watertight: bool = False
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)
    with_light: bool = True

    def __post_init__(self) -> None:
        """Check the values.

        Raises:
            ExportError: One is out of range; it is named.
        """
        if self.faces < 4:
            raise ExportError(f"faces is {self.faces}: a surface needs 4 or more")
        if self.texture_size and not 16 <= self.texture_size <= 8192:
            raise ExportError(f"texture size {self.texture_size} is not in 16 to 8192 (or 0)")
        if not 0.0 < float(np.linalg.norm(self.up)) < np.inf:
            raise ExportError(f"up is {self.up}: it must be a direction")


def scan_asset(
    scan: Scan, found: MaterialMap, name: str, settings: AssetSettings | None = None
) -> Asset:
    """The scanned surface with its materials, albedo texture and light.

    Args:
        scan: What was fused.
        found: The materials of this scan.
        name: Of the asset.
        settings: How the surface is written; None for the defaults.

    Raises:
        ExportError: There is no surface or no material, or a package is missing.
    """
    settings = settings or AssetSettings()
    mesh = scanned_mesh(scan, settings.faces, settings.is_watertight, settings.up)
    return mesh_asset(mesh, scan.fusion.voxel_size, found, name, settings)


def mesh_asset(
    mesh: TriangleMesh, voxel_size: float, found: MaterialMap, name: str, settings: AssetSettings
) -> Asset:
    """A mesh that was extracted before, with its materials.

    Args:
        mesh: Of :func:`.scanned_mesh`.
        voxel_size: Edge of a voxel of the scan, metres.
        found: The materials of this scan.
        name: Of the asset.
        settings: How the surface is written.

    Raises:
        ExportError: There is no material, or a package is missing.
    """
    if not found.materials:
        raise ExportError("the scan has no material with an estimate: scan more of the surface")
    stem = name if name.endswith("material") else f"{name}_material"
    materials = tuple(
        AssetMaterial.of(one.estimate, f"{stem}_{one.id}", one.id) for one in found.materials
    )
    index_of = {one.id: index for index, one in enumerate(found.materials)}
    voxels = _Voxels(found, index_of, voxel_size, np.asarray(settings.up, np.float64))
    mesh, labels = _seamed(mesh, voxels, settings.faces)
    size = settings.texture_size or _texture_size(mesh, voxel_size)
    atlas = unwrapped(mesh, labels, size)
    texture = _baked(mesh, labels, atlas, voxels, materials, voxel_size)
    x, y, z = (rotation_to_z(settings.up) @ found.surface.origin).tolist()
    return Asset(
        name,
        _upright_mesh(mesh, labels, atlas, voxels, found, settings.up),
        materials,
        texture,
        _light(found, settings.up) if settings.with_light else None,
        origin=(x, y, z),
    )


def _light(found: MaterialMap, up: tuple[float, float, float]) -> EnvironmentMap | None:
    """The light that the materials were estimated in, z up."""
    if found.light is not None:
        return from_octahedral(found.light.completed.levels[0])
    surface = upright(found.surface, up)
    if surface.light is None or not surface.light.seen_share > 0.0:
        return None
    return environment_map(surface)


class _Voxels:
    """The voxels of the map's materials, to look up by position."""

    def __init__(
        self,
        found: MaterialMap,
        index_of: dict[int, int],
        voxel_size: float,
        up: NDArray[np.float64],
    ) -> None:
        ids = found.material_ids
        labels = np.array([index_of.get(int(one), -1) for one in ids], np.int32)
        is_used = labels >= 0
        self.labels = labels[is_used]
        self.voxel_size, self.up = voxel_size, up / np.linalg.norm(up)
        self.positions = found.surface.positions[is_used]
        self.normals = found.surface.normals[is_used]
        self.rho_d, self.rho_d_stddev = found.rho_d[is_used], found.rho_d_stddev[is_used]
        self.tree = cKDTree(self.positions)

    @cached_property
    def _facing_tree(self) -> cKDTree:
        return cKDTree(np.hstack([self.positions, TURNED * self.voxel_size * self.normals]))

    def material_at(
        self, places: NDArray[np.float64], normals: NDArray[np.float64]
    ) -> NDArray[np.int32]:
        """(P,) index of the material that most of the nearest voxels have.

        Voxels that face elsewhere count as farther: where an object stands on a table the seam
        follows the edge between both. What was filled in below an overhang is the object's.
        """
        lengths = np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        facing = TURNED * self.voxel_size * normals / lengths
        count = min(VOTERS, len(self.labels))
        distances, near = self._facing_tree.query(np.hstack([places, facing]), k=count)
        distances, near = distances.reshape(-1, count), near.reshape(-1, count)
        labels = self.labels[near]
        votes = (labels[:, :, None] == labels[:, None, :]).sum(axis=2)
        found = np.take_along_axis(labels, votes.argmax(axis=1)[:, None], axis=1)[:, 0]
        is_filled = distances[:, 0] > FILLED_BEYOND * self.voxel_size
        is_filled &= normals @ self.up < LEVEL * lengths[:, 0]
        above = self._overhang_of(places[is_filled])
        found[is_filled] = np.where(above >= 0, self.labels[above], found[is_filled])
        return found

    @cached_property
    def _overhangs(self) -> tuple[NDArray[np.intp], cKDTree]:
        rows = np.flatnonzero(self.normals @ self.up < LEVEL)
        return rows, cKDTree(self.positions[rows])

    def _overhang_of(self, places: NDArray[np.float64]) -> NDArray[np.intp]:
        """(P,) the nearest voxel that does not lie level and is higher; -1 where there is none."""
        rows, tree = self._overhangs
        ranks = np.arange(1, min(ABOVE, len(rows)) + 1)
        if not len(ranks):
            return np.full(len(places), -1, np.intp)
        farthest = OVERHANG * self.voxel_size
        _, near = tree.query(places, k=ranks, distance_upper_bound=farthest)
        rows = np.append(rows, -1)[near]  # the tree gives len(rows) for none
        heights = np.where(rows >= 0, (self.positions @ self.up)[rows], -np.inf)
        is_above = heights > (places @ self.up)[:, None]
        first = np.take_along_axis(rows, is_above.argmax(axis=1)[:, None], axis=1)[:, 0]
        return np.where(is_above.any(axis=1), first, -1)


def _seamed(
    mesh: TriangleMesh, voxels: _Voxels, faces: int
) -> tuple[TriangleMesh, NDArray[np.int32]]:
    """The mesh, cut along the materials' borders into at most ``faces``, and its faces' labels."""
    cut, labels = cut_at_seams(mesh, voxels.material_at)
    surplus = len(cut.faces) - faces
    if surplus > 0:
        fewer = decimated(mesh, max(len(mesh.faces) - round(SURPLUS * surplus), 4))
        cut, labels = cut_at_seams(fewer, voxels.material_at)
    return cut, labels


def _texture_size(mesh: TriangleMesh, voxel_size: float) -> int:
    area = 0.5 * float(np.linalg.norm(mesh.face_normals, axis=1).sum())
    # Charts fill about two thirds of the page.
    wanted = TEXELS_PER_VOXEL / voxel_size * np.sqrt(1.5 * area)
    return next((size for size in SIZES if size >= wanted), SIZES[-1])


def _baked(
    mesh: TriangleMesh,
    labels: NDArray[np.int32],
    atlas: Atlas,
    voxels: _Voxels,
    materials: tuple[AssetMaterial, ...],
    voxel_size: float,
) -> NDArray[np.uint8]:
    texels, face, weights = covered_texels(atlas.uv, atlas.faces, atlas.size)
    corners = mesh.vertices[mesh.faces[face]]
    places = np.einsum("tk,tkc->tc", weights, corners).astype(np.float32)
    rho_d = interpolated(
        places, labels[face], voxels.positions, voxels.labels, voxels.rho_d, 0.7 * voxel_size
    )
    of_material = np.array([one.ward.rho_d for one in materials], np.float32)[labels[face]]
    rho_d = np.where(np.isfinite(rho_d), rho_d, of_material)
    f0 = np.array([MicrofacetMaterial.from_ward(one.ward).f0 for one in materials])[labels[face]]
    return filled(texels, base_colour(rho_d, f0[:, None]).astype(np.float32), atlas.size)


def _upright_mesh(
    mesh: TriangleMesh,
    labels: NDArray[np.int32],
    atlas: Atlas,
    voxels: _Voxels,
    found: MaterialMap,
    up: tuple[float, float, float],
) -> AssetMesh:
    rotation = rotation_to_z(up).astype(np.float32)
    vertices = mesh.vertices[atlas.source]
    label = np.zeros(len(vertices), np.int32)
    label[atlas.faces] = labels[:, None]
    _, near = voxels.tree.query(vertices)
    estimates = [one.estimate for one in found.materials]
    attributes = {
        "material_id": np.array([one.id for one in found.materials], np.float32)[label],
        "rho_d_stddev": voxels.rho_d_stddev[near],
        "rho_s_stddev": np.array([e.rho_s_stddev for e in estimates], np.float32)[label],
        "alpha_stddev": np.array([e.alpha_stddev for e in estimates], np.float32)[label],
    }
    return AssetMesh(
        vertices @ rotation.T,
        mesh.vertex_normals[atlas.source] @ rotation.T,
        atlas.faces,
        labels,
        atlas.uv,
        # Files of these formats hold no NaN.
        {name: np.where(np.isfinite(v), v, UNKNOWN) for name, v in attributes.items()},
    )
