# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Painting a mesh: with a pattern in the diffuse albedo, or with two materials."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.scenes.material_sources import Materials, NamedMaterial
from reflest_core.synbrdf.scenes.painted_mesh import PaintedMesh
from reflest_core.synbrdf.scenes.scene_materials import PLAIN, SceneMaterial
from reflest_core.synbrdf.shapes.mesh import TriangleMesh

FloatArray = NDArray[np.float64]
KINDS = ("checker", "stripes", "spots", "grain")
CELLS = (0.02, 0.06)
"""Metres, width of a pattern's cells; whole multiples of :data:`TEXEL`."""
TEXEL = 0.005
"""Metres, the longest edge of faces that a pattern is painted on."""


@dataclass(frozen=True)
class Texture:
    """A pattern of two albedos.

    Attributes:
        kind: One of :data:`KINDS`.
        axes: (3, 3), rows are the pattern's axes in the frame of its mesh.
        cell: Metres.
        other: Diffuse albedo (3,) of the pattern's second colour, linear sRGB.
        phases: (8,) random numbers in [0, 1) that place spots and grain.
    """

    kind: str
    axes: FloatArray
    cell: float
    other: FloatArray
    phases: FloatArray

    def share(self, points: FloatArray) -> FloatArray:
        """Compute the share of the second colour.

        Args:
            points: (N, 3) metres.

        Returns:
            (N,) in [0, 1].
        """
        place = points @ self.axes.T / self.cell
        if self.kind == "checker":
            return np.asarray(np.floor(place + 1e-6).sum(axis=1) % 2)
        if self.kind == "stripes":
            return np.asarray(np.floor(place[:, 0] + 1e-6) % 2)
        if self.kind == "spots":
            within = place - np.floor(place) - 0.5
            return np.asarray(np.linalg.norm(within, axis=1) < 0.45, np.float64)
        bend = np.sin(2 * np.pi * (0.11 * place[:, 1] + self.phases[0]))
        bend += 0.5 * np.sin(2 * np.pi * (0.23 * place[:, 2] + self.phases[1]))
        rings = np.sin(2 * np.pi * (1.3 * place[:, 0] + self.phases[2] + bend))
        fine = np.sin(2 * np.pi * (3.7 * place[:, 0] + self.phases[3] + 1.7 * bend))
        return np.asarray(0.5 + 0.35 * rings + 0.15 * fine)


def draw_texture(
    rng: np.random.Generator, materials: Materials, axes: FloatArray, rho_s: float
) -> Texture:
    """Draw a pattern; its second colour keeps within energy.

    Args:
        rng: random numbers; the same state draws the same.
        materials: what its second colour is drawn from.
        axes: (3, 3) axes of the pattern, in rows.
        rho_s: specular albedo of the material.
    """
    kind = KINDS[int(rng.integers(len(KINDS)))]
    cell = TEXEL * int(rng.integers(round(CELLS[0] / TEXEL), round(CELLS[1] / TEXEL) + 1))
    other = np.array(materials.draw(rng).ward.rho_d)
    other = other * min(1.0, (1.0 - rho_s) / max(float(other.max()), 1e-6))
    return Texture(kind, axes, cell, other, rng.uniform(size=8))


def one_material(
    mesh: TriangleMesh, named: NamedMaterial, part: str, texture: Texture | None = None
) -> PaintedMesh:
    """Paint a mesh with one material, its albedo patterned or plain.

    Args:
        mesh: In the frame of the texture's axes.
        named: The material.
        part: Name of what it covers.
        texture: None for one plain colour.
    """
    first = np.array(named.ward.rho_d)
    if texture is None:
        rho_d = np.tile(first, (len(mesh.faces), 1))
    else:
        share = texture.share(mesh.vertices[mesh.faces].mean(axis=1))[:, None]
        rho_d = first + share * (texture.other - first)
    material = SceneMaterial.of(named, part, PLAIN if texture is None else texture.kind)
    ids = np.zeros(len(mesh.faces), np.int32)
    return PaintedMesh(mesh, (material,), ids, rho_d.astype(np.float32))


def two_materials(
    mesh: TriangleMesh, first: NamedMaterial, second: NamedMaterial, part: str, cut: FloatArray
) -> PaintedMesh:
    """A mesh whose faces beyond a plane are of a second material.

    Args:
        mesh: Its origin lies within it.
        first: Material on the near side of the plane.
        second: Material on the far side.
        part: Name of what they cover.
        cut: (4,), the plane's unit normal and its distance from the origin in metres.
    """
    middles = mesh.vertices[mesh.faces].mean(axis=1)
    ids = (middles @ cut[:3] > cut[3]).astype(np.int32)
    wards = np.array([first.ward.rho_d, second.ward.rho_d], np.float32)
    materials = SceneMaterial.of(first, part), SceneMaterial.of(second, part)
    return PaintedMesh(mesh, materials, ids, wards[ids])
