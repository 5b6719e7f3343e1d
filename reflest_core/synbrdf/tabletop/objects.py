# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Objects that stand about on a table, each of one or two materials."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters
from reflest_core.synbrdf.scenes.material_sources import Materials, NamedMaterial
from reflest_core.synbrdf.scenes.painted_mesh import PaintedMesh
from reflest_core.synbrdf.scenes.scene_materials import OBJECT
from reflest_core.synbrdf.shapes.mesh import TriangleMesh
from reflest_core.synbrdf.shapes.mesh_file import MeshSource, load_mesh
from reflest_core.synbrdf.shapes.procedural import draw_procedural, draw_rotation
from reflest_core.synbrdf.tabletop.texture import (
    TEXEL,
    draw_texture,
    one_material,
    two_materials,
)

FloatArray = NDArray[np.float64]
COUNTS = (2, 6)
DIAMETERS = (0.12, 0.24)
"""Metres."""
REACH = 0.26
"""Metres from the middle of the ground to an object's."""
GAP = 0.015
"""Metres between two objects, seen from above."""
SINK = 5e-4
"""Metres that an object sinks into the ground, so that no light passes below its lowest point."""
TWO_MATERIALS_SHARE, TEXTURED_SHARE, FILE_SHARE = 0.25, 0.2, 0.6
TRIES = 200


@dataclass(frozen=True)
class ChosenObject:
    """An object whose kind of shape and material the user chose.

    Attributes:
        shape: Kind of procedural shape.
        ward: Ward parameters, linear sRGB.
    """

    shape: str
    ward: WardParameters


def draw_objects(
    rng: np.random.Generator,
    meshes: list[MeshSource],
    materials: Materials,
    chosen: tuple[ChosenObject, ...] = (),
) -> tuple[list[PaintedMesh], list[str]]:
    """Draw 2 to 6 objects on z = 0 that do not touch each other.

    Args:
        rng: Source of the draw.
        meshes: To draw from; none: all shapes are procedural.
        materials: What to draw materials from.
        chosen: The first of these stand there instead; fewer where the ground has no room.

    Returns:
        The objects in their places and the names of their shapes.
    """
    wanted = len(chosen) or int(rng.integers(COUNTS[0], COUNTS[1] + 1))
    objects: list[PaintedMesh] = []
    names: list[str] = []
    taken: list[tuple[FloatArray, float]] = []
    for _ in range(TRIES):
        if len(objects) == wanted:
            break
        choice = chosen[len(objects)] if chosen else None
        mesh, name = _draw_shape(rng, meshes, None if choice is None else choice.shape)
        radius = float(np.linalg.norm(mesh.vertices[:, :2], axis=1).max())
        place = _free_place(rng, radius, taken)
        if place is None:
            continue
        taken.append((place, radius))
        part = f"{OBJECT}-{len(objects) + 1}"
        if choice is None:
            painted = _draw_paint(rng, mesh, part, materials)
        else:
            painted = one_material(mesh, NamedMaterial.given(choice.ward), part)
        lowest = float(mesh.vertices[:, 2].min())
        objects.append(painted.shifted(np.array([*place, -lowest - SINK])))
        names.append(name)
    return objects, names


def _draw_shape(
    rng: np.random.Generator, meshes: list[MeshSource], kind: str | None
) -> tuple[TriangleMesh, str]:
    from_file = kind is None and len(meshes) > 0 and rng.uniform() < FILE_SHARE
    if from_file:
        source = meshes[int(rng.integers(len(meshes)))]
        mesh, name = load_mesh(source), source.name
    else:
        mesh, name = draw_procedural(rng, kind)
    is_upright = from_file or rng.uniform() < 0.5 or kind is not None
    rotation = draw_rotation(rng, upright=bool(is_upright))
    return mesh.moved(rotation, float(rng.uniform(*DIAMETERS))), name


def _free_place(
    rng: np.random.Generator, radius: float, taken: list[tuple[FloatArray, float]]
) -> FloatArray | None:
    for _ in range(20):
        place = rng.uniform(-REACH, REACH, 2)
        if np.linalg.norm(place) <= REACH and all(
            np.linalg.norm(place - other) > radius + others + GAP for other, others in taken
        ):
            return np.asarray(place)
    return None


def _draw_paint(
    rng: np.random.Generator, mesh: TriangleMesh, part: str, materials: Materials
) -> PaintedMesh:
    kind = rng.uniform()
    named = materials.draw(rng)
    if kind < TWO_MATERIALS_SHARE:
        fine = mesh.subdivided(TEXEL)
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        # Through the middle half of the surface along the normal, so that neither side is tiny.
        along = fine.vertices @ normal
        distance = float(np.quantile(along, rng.uniform(0.3, 0.7)))
        return two_materials(fine, named, materials.draw(rng), part, np.array([*normal, distance]))
    if kind < TWO_MATERIALS_SHARE + TEXTURED_SHARE:
        axes = draw_rotation(rng, upright=False)
        texture = draw_texture(rng, materials, axes, named.ward.rho_s)
        return one_material(mesh.subdivided(TEXEL), named, part, texture)
    return one_material(mesh, named, part)
