# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Meshes with a material for each face; one material is the case of one."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.scenes.scene_materials import OBJECT, SceneMaterial, VoxelMaterials
from reflest_core.synbrdf.shapes.mesh import TriangleMesh

OBJECT_SHARE = 0.6
"""Of the voxels of an observation scene lie on objects: the table's area is many times theirs."""


@dataclass(frozen=True)
class PaintedMesh:
    """A mesh of one or many materials.

    Attributes:
        mesh: Triangles, metres.
        materials: Materials by id.
        material_of_face: (F,) int32, id of each face's material.
        rho_d: (F, 3) float32, diffuse albedo of each face, linear sRGB.
    """

    mesh: TriangleMesh
    materials: tuple[SceneMaterial, ...]
    material_of_face: NDArray[np.int32]
    rho_d: NDArray[np.float32]

    @classmethod
    def uniform(cls, mesh: TriangleMesh, material: SceneMaterial) -> PaintedMesh:
        """All faces of one material.

        Args:
            mesh: Triangles, metres.
            material: The material.
        """
        count = len(mesh.faces)
        rho_d = np.tile(np.array(material.ward.rho_d, np.float32), (count, 1))
        return cls(mesh, (material,), np.zeros(count, np.int32), rho_d)

    @property
    def is_uniform(self) -> bool:
        """Whether there is one material."""
        return len(self.materials) == 1

    @property
    def rho_s(self) -> NDArray[np.float32]:
        """(F,) specular albedo of each face."""
        values = [material.ward.rho_s for material in self.materials]
        return np.array(values, np.float32)[self.material_of_face]

    @property
    def alpha(self) -> NDArray[np.float32]:
        """(F,) roughness of each face."""
        values = [material.ward.alpha for material in self.materials]
        return np.array(values, np.float32)[self.material_of_face]

    def at_faces(self, faces: NDArray[np.int64]) -> VoxelMaterials:
        """Materials of V voxels.

        Args:
            faces: (V,) index of the face that each lies on.
        """
        ids = self.material_of_face[faces].astype(np.uint16)
        return VoxelMaterials(self.materials, ids, self.rho_d[faces], self._dominant_id())

    def cards(self) -> list[dict[str, Any]]:
        """What a JSON file says of the materials, by id."""
        return [material.card() for material in self.materials]

    def densities(self) -> NDArray[np.float64]:
        """(F,) relative density of points under which objects have :data:`OBJECT_SHARE` of them."""
        is_object = np.array([material.part.startswith(OBJECT) for material in self.materials])
        on_object, areas = is_object[self.material_of_face], self.mesh.face_areas
        objects, ground = areas[on_object].sum(), areas[~on_object].sum()
        weights = np.where(on_object, OBJECT_SHARE / objects, (1.0 - OBJECT_SHARE) / ground)
        return np.asarray(weights * (objects + ground))

    @property
    def dominant(self) -> SceneMaterial:
        """The material of the largest area."""
        return self.materials[self._dominant_id()]

    def _dominant_id(self) -> int:
        areas = np.bincount(self.material_of_face, self.mesh.face_areas, len(self.materials))
        return int(areas.argmax())

    def shifted(self, offset: NDArray[np.float64]) -> PaintedMesh:
        """The same at another place.

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
        tuple(material for part in parts for material in part.materials),
        np.concatenate(ids).astype(np.int32),
        np.concatenate([part.rho_d for part in parts]),
    )
