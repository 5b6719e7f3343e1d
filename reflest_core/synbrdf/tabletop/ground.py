# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What objects stand on: a table, or the corner of a room."""

from __future__ import annotations

import enum

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.scenes.material_sources import Materials, NamedMaterial
from reflest_core.synbrdf.scenes.painted_mesh import PaintedMesh, joined
from reflest_core.synbrdf.shapes.mesh import TriangleMesh, grid_faces
from reflest_core.synbrdf.tabletop.texture import TEXEL, draw_texture, one_material

FloatArray = NDArray[np.float64]
TABLE_EXTENTS = (0.3, 0.45)
"""Metres, half of a table's edges or the radius of a round one."""
THICKNESS = 0.03
ROUND_SHARE = 0.25
TEXTURED_SHARE = 0.4
"""Of tables, floors and walls."""
CORNER_EXTENT = 0.45
"""Metres from the middle of a corner's floor to each edge."""
WALL_HEIGHTS = (0.35, 0.6)


class Setting(enum.Enum):
    """What objects stand on."""

    TABLE = "table"
    """A slab that hangs free, seen from all sides."""
    CORNER = "corner"
    """A floor and two walls, seen from the open side."""


def draw_ground(
    rng: np.random.Generator,
    setting: Setting,
    materials: Materials,
    chosen: NamedMaterial | None = None,
) -> PaintedMesh:
    """The ground that objects stand on at z = 0, with its middle at the origin.

    Args:
        rng: random numbers; the same state draws the same.
        setting: table or corner.
        materials: the source of materials.
        chosen: what a table is made of, without a pattern; None draws material and pattern.
    """
    if setting is Setting.TABLE:
        half = rng.uniform(*TABLE_EXTENTS, 2)
        is_round = rng.uniform() < ROUND_SHARE
        top = _disc(half[0]) if is_round else _sheet(half)
        rim = _rim(_circle(half[0]) if is_round else _rectangle(half))
        named = chosen or materials.draw(rng)
        painted_top = (
            _textured(rng, top, "table", materials, named)
            if chosen is None
            else one_material(top, named, "table")
        )
        slab = joined([painted_top, one_material(rim, named, "table")])
        # Both are of one material; the rim has no pattern.
        ids = np.zeros_like(slab.material_of_face)
        return PaintedMesh(slab.mesh, slab.materials[:1], ids, slab.rho_d)
    half = np.full(2, CORNER_EXTENT)
    height = float(rng.uniform(*WALL_HEIGHTS))
    floor = _textured(rng, _sheet(half), "floor", materials, materials.draw(rng))
    has_one_paint = rng.uniform() < 0.5
    paint = materials.draw(rng)
    other = paint if has_one_paint else materials.draw(rng)
    upright = _sheet(np.array([CORNER_EXTENT, 0.5 * height]))
    along_x = _turned(upright, [[1, 0, 0], [0, 0, -1], [0, 1, 0]], [0, CORNER_EXTENT, height / 2])
    along_y = _turned(upright, [[0, 0, -1], [-1, 0, 0], [0, 1, 0]], [CORNER_EXTENT, 0, height / 2])
    if has_one_paint:
        walls = TriangleMesh(
            np.concatenate([along_x.vertices, along_y.vertices]),
            np.concatenate([along_x.normals, along_y.normals]),
            np.concatenate([along_x.faces, along_y.faces + len(along_x.vertices)]),
        )
        return joined([floor, _textured(rng, walls, "walls", materials, paint)])
    sides = [(along_x, "wall-1", paint), (along_y, "wall-2", other)]
    return joined([floor, *(_textured(rng, m, name, materials, p) for m, name, p in sides)])


def _textured(
    rng: np.random.Generator,
    mesh: TriangleMesh,
    part: str,
    materials: Materials,
    named: NamedMaterial,
) -> PaintedMesh:
    if rng.uniform() >= TEXTURED_SHARE:
        return one_material(mesh, named, part)
    turn = rng.integers(4) * np.pi / 2
    cosine, sine = np.cos(turn), np.sin(turn)
    axes = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    texture = draw_texture(rng, materials, axes, named.ward.rho_s)
    return one_material(mesh, named, part, texture)


def _sheet(half: FloatArray) -> TriangleMesh:
    """A rectangle at z = 0 of TEXEL-wide quads on whole multiples of it, facing up."""
    counts = np.maximum(np.rint(half / TEXEL).astype(int), 1)
    x, y = (TEXEL * np.arange(-count, count + 1) for count in counts)
    vertices = np.stack(np.meshgrid(x, y, [0.0]), axis=-1).reshape(-1, 3)
    faces = grid_faces(len(y), len(x), wrap_rows=False, wrap_columns=False)
    return _facing(vertices, faces, np.array([0.0, 0.0, 1.0]))


def _disc(radius: float) -> TriangleMesh:
    square = _sheet(np.array([radius, radius]))
    # The quads of the outline are cut off where they pass it: their far vertices move onto it.
    distance = np.linalg.norm(square.vertices, axis=1, keepdims=True)
    corners = distance[square.faces, 0]
    faces = square.faces[(corners < radius).any(axis=1)]
    vertices = square.vertices * np.minimum(1.0, radius / np.maximum(distance, 1e-12))
    return TriangleMesh(vertices, square.normals, faces)


def _circle(radius: float) -> FloatArray:
    angle = 2.0 * np.pi * np.arange(96) / 96
    return np.asarray(radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))


def _rectangle(half: FloatArray) -> FloatArray:
    half = TEXEL * np.maximum(np.rint(half / TEXEL), 1)
    return np.asarray(half * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]))


def _rim(outline: FloatArray) -> TriangleMesh:
    """Side faces and underside of a slab below an outline (N, 2), anticlockwise; flat shading."""
    count = len(outline)
    upper = np.column_stack([outline, np.zeros(count)])
    lower = upper - [0.0, 0.0, THICKNESS]
    following = np.roll(np.arange(count), -1)
    sides = [(upper, lower, lower[following]), (upper, lower[following], upper[following])]
    triangles = [np.stack(corners, axis=1) for corners in sides]
    middle = np.tile([0.0, 0.0, -THICKNESS], (count, 1))
    triangles.append(np.stack([middle, lower[following], lower], axis=1))
    corners = np.concatenate(triangles)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    faces = np.arange(3 * len(corners)).reshape(-1, 3)
    return TriangleMesh(corners.reshape(-1, 3), np.repeat(normal, 3, axis=0), faces)


def _turned(mesh: TriangleMesh, rotation: list[list[int]], offset: list[float]) -> TriangleMesh:
    matrix = np.array(rotation, np.float64)
    return TriangleMesh(
        mesh.vertices @ matrix.T + np.array(offset), mesh.normals @ matrix.T, mesh.faces
    )


def _facing(vertices: FloatArray, faces: NDArray[np.int64], normal: FloatArray) -> TriangleMesh:
    a, b, c = vertices[faces[0]]
    turned = faces if np.cross(b - a, c - a) @ normal > 0.0 else faces[:, ::-1]
    return TriangleMesh(vertices, np.tile(normal, (len(vertices), 1)), turned)
