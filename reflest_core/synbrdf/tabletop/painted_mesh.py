# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Meshes whose faces have materials of their own."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.scenes.material_sources import NamedMaterial
from reflest_core.synbrdf.scenes.voxel_materials import MaterialTruth, VoxelMaterials
from reflest_core.synbrdf.shapes.mesh import TriangleMesh

OBJECT = "object-"
"""Begins the names of objects among the parts of a scene; others are of the ground."""
OBJECT_SHARE = 0.6
"""Of the voxels of an observation scene lie on objects: the table's area is many times theirs."""


@dataclass(frozen=True)
class SceneMaterial:
    """A material of a scene, as its truth names it.

    Attributes:
        named: Ward values and source; ``rho_d`` is that of most of the surface.
        part: What it covers, such as ``table`` or ``object-2``.
        texture: Kind of the pattern in ``rho_d``; ``plain`` without one.
    """

    named: NamedMaterial
    part: str
    texture: str

    def truth(self) -> MaterialTruth:
        """As files hold it."""
        named = self.named
        return MaterialTruth(named.ward, named.source.value, named.name, self.part, self.texture)


@dataclass(frozen=True)
class PaintedMesh:
    """A mesh of several materials.

    Attributes:
        mesh: Triangles, metres.
        materials: Materials by id.
        material_of_face: (F,) int32, id of each face's material.
        rho_d: (F, 3) float32, diffuse albedo of each face, linear sRGB.
    """

    mesh: TriangleMesh
    materials: list[SceneMaterial]
    material_of_face: NDArray[np.int32]
    rho_d: NDArray[np.float32]

    @property
    def rho_s(self) -> NDArray[np.float32]:
        """(F,) specular strength of each face."""
        values = [material.named.ward.rho_s for material in self.materials]
        return np.array(values, np.float32)[self.material_of_face]

    @property
    def alpha(self) -> NDArray[np.float32]:
        """(F,) roughness of each face."""
        values = [material.named.ward.alpha for material in self.materials]
        return np.array(values, np.float32)[self.material_of_face]

    def at_faces(self, faces: NDArray[np.int64]) -> VoxelMaterials:
        """Materials of V voxels.

        Args:
            faces: (V,) index of the face that each lies on.
        """
        truths = tuple(material.truth() for material in self.materials)
        ids = self.material_of_face[faces].astype(np.uint16)
        return VoxelMaterials(truths, ids, self.rho_d[faces])

    def cards(self) -> list[dict[str, Any]]:
        """What a JSON file says of the materials, by id."""
        return [material.truth().card() for material in self.materials]

    def densities(self) -> NDArray[np.float64]:
        """(F,) relative density of points under which objects have :data:`OBJECT_SHARE` of them."""
        is_object = np.array([material.part.startswith(OBJECT) for material in self.materials])
        on_object, areas = is_object[self.material_of_face], self.mesh.face_areas
        objects, ground = areas[on_object].sum(), areas[~on_object].sum()
        weights = np.where(on_object, OBJECT_SHARE / objects, (1.0 - OBJECT_SHARE) / ground)
        return np.asarray(weights * (objects + ground))

    def largest(self) -> NamedMaterial:
        """The material of the largest area."""
        areas = np.bincount(self.material_of_face, self.mesh.face_areas, len(self.materials))
        return self.materials[int(areas.argmax())].named

    def shifted(self, offset: NDArray[np.float64]) -> PaintedMesh:
        """The same at another place; ``offset`` (3,) in metres.

        Args:
            offset: (3,) metres.
        """
        return dataclasses.replace(self, mesh=self.mesh.shifted(offset))


def joined(parts: list[PaintedMesh]) -> PaintedMesh:
    """One mesh of several; ids of materials count on from part to part.

    Args:
        parts: meshes with materials.
    """
    vertices = np.cumsum([0] + [len(part.mesh.vertices) for part in parts])
    first_id = np.cumsum([0] + [len(part.materials) for part in parts])
    mesh = TriangleMesh(
        np.concatenate([part.mesh.vertices for part in parts]),
        np.concatenate([part.mesh.normals for part in parts]),
        np.concatenate([p.mesh.faces + n for p, n in zip(parts, vertices[:-1], strict=True)]),
    )
    ids = [p.material_of_face + n for p, n in zip(parts, first_id[:-1], strict=True)]
    return PaintedMesh(
        mesh,
        [material for part in parts for material in part.materials],
        np.concatenate(ids).astype(np.int32),
        np.concatenate([part.rho_d for part in parts]),
    )
