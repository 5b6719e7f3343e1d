# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Meshes from disk: a folder of .obj and .ply files, or of .npz collections."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.array_file import array_names, read_member
from reflest_core.errors import ReflestError
from reflest_core.synbrdf.shapes.mesh import (
    FloatArray,
    IntArray,
    TriangleMesh,
    facing_outwards,
    with_crease_normals,
)

LARGEST = 1e9
"""Coordinates, in whatever unit the file has; far below what overflows in products."""


class MeshUnreadable(ReflestError):
    """A mesh file cannot be used."""


@dataclass(frozen=True)
class MeshSource:
    """One mesh that :func:`load_mesh` can read.

    Attributes:
        name: Of the mesh.
        path: Its file.
        member: Its name inside a collection.
    """

    name: str
    path: Path
    member: str | None = None


def find_meshes(path: Path) -> list[MeshSource]:
    """List the meshes in a file or folder, sorted by name.

    An .npz collection holds ``NAME/v`` (V, 3), float or uint16 (``v / 32767.5 - 1``), and
    ``NAME/f`` (F, 3).

    Args:
        path: a file, or a folder of them.
    """
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    sources: list[MeshSource] = []
    for file in files:
        if file.suffix.lower() in (".obj", ".ply"):
            sources.append(MeshSource(file.stem, file))
        elif file.suffix.lower() == ".npz":
            sources += [MeshSource(name, file, name) for name in _collection_names(file)]
    if not sources:
        raise MeshUnreadable(f"{path} holds no mesh: it needs .obj, .ply or .npz files")
    return sorted(sources, key=lambda source: source.name)


def load_mesh(source: MeshSource) -> TriangleMesh:
    """Read a mesh; edges sharper than 40 degrees stay sharp.

    Args:
        source: the file or procedural kind.
    """
    try:
        vertices, faces = _read(source)
        if len(faces) == 0 or not (np.abs(vertices) < LARGEST).all():
            raise ValueError(f"it has no faces, or vertices that are not within {LARGEST:g}")
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise ValueError("a face names a vertex that does not exist")
        mesh = with_crease_normals(vertices, facing_outwards(vertices, faces))
        if len(mesh.faces) == 0:
            raise ValueError("its faces have no area")
        return mesh
    except (OSError, ValueError, IndexError, RuntimeError, OverflowError, TypeError) as error:
        raise MeshUnreadable(f"mesh {source.name} in {source.path} is unusable: {error}") from error


def _collection_names(path: Path) -> list[str]:
    try:
        return [name[:-2] for name in array_names(path) if name.endswith("/v")]
    except (OSError, ValueError) as error:
        raise MeshUnreadable(f"{path} is not a readable .npz file: {error}") from error


def _read(source: MeshSource) -> tuple[FloatArray, IntArray]:
    if source.member is not None:
        stored = read_member(source.path, f"{source.member}/v")
        faces = read_member(source.path, f"{source.member}/f")
        scale, shift = (1 / 32767.5, -1.0) if stored.dtype == np.uint16 else (1.0, 0.0)
        return stored.astype(np.float64) * scale + shift, faces.astype(np.int64)
    if source.path.suffix.lower() == ".obj":
        return _read_obj(source.path)
    return _read_ply(source.path)


def _read_obj(path: Path) -> tuple[FloatArray, IntArray]:
    """Positions and faces only; polygons become fans; negative indices count from the end."""
    vertices: list[list[float]] = []
    faces: list[list[int]] = []
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [corner - 1 if corner > 0 else len(vertices) + corner for corner in corners]
            faces += [[corners[0], b, c] for b, c in pairwise(corners[1:])]
    return _arrays(vertices, faces)


def _read_ply(path: Path) -> tuple[FloatArray, IntArray]:
    """Any .ply that Mitsuba reads."""
    from reflest_core.synbrdf.path_tracing.mitsuba_runtime import load_mitsuba

    mi = load_mitsuba()
    parameters = mi.traverse(mi.load_dict({"type": "ply", "filename": str(path)}))
    vertices = np.array(parameters["vertex_positions"], dtype=np.float64).reshape(-1, 3)
    faces = np.array(parameters["faces"], dtype=np.int64).reshape(-1, 3)
    # Mitsuba splits vertices by normal; merge them so that creases are found again.
    merged, index = np.unique(vertices, axis=0, return_inverse=True)
    return merged, index.reshape(-1)[faces]


def _arrays(
    vertices: list[list[float]], faces: list[list[int]]
) -> tuple[FloatArray, NDArray[np.int64]]:
    return (
        np.array(vertices, dtype=np.float64).reshape(-1, 3),
        np.array(faces, dtype=np.int64).reshape(-1, 3),
    )
