# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An asset's parts as trimesh's geometries, which write glTF, OBJ and PLY."""

from __future__ import annotations

from typing import Any

import numpy as np

from reflest_core.export.asset import Asset, AssetMesh
from reflest_core.export.libraries import library
from reflest_core.export.microfacet_material import MicrofacetMaterial


def trimesh_parts(asset: Asset) -> dict[str, Any]:
    """One ``trimesh.Trimesh`` with a PBR material for each material that has faces, by name.

    Args:
        asset: What to convert. The geometries stay z up.
    """
    trimesh = library("trimesh")
    picture = texture_picture(asset)
    parts = {}
    for index, material in enumerate(asset.materials):
        mesh = asset.mesh.part(index)
        if not len(mesh.faces):
            continue
        microfacet = MicrofacetMaterial.from_ward(material.ward)
        has_texture = picture is not None and mesh.uv is not None
        pbr = trimesh.visual.material.PBRMaterial(
            name=material.name,
            baseColorTexture=picture if has_texture else None,
            baseColorFactor=None if has_texture else [*microfacet.base_colour, 1.0],
            metallicFactor=0.0,
            roughnessFactor=microfacet.roughness,
        )
        visual = trimesh.visual.TextureVisuals(uv=_uv(mesh), material=pbr)
        parts[material.name] = trimesh.Trimesh(
            mesh.vertices,
            mesh.faces,
            vertex_normals=mesh.normals,
            visual=visual,
            vertex_attributes=dict(mesh.attributes),
            process=False,
        )
    return parts


def texture_picture(asset: Asset) -> Any:
    """The base colour texture as a ``PIL.Image``; None for an asset without one.

    Args:
        asset: with its baked textures.
    """
    if asset.base_colour is None:
        return None
    picture = library("PIL.Image").fromarray(asset.base_colour)
    picture.format = "PNG"
    return picture


def _uv(mesh: AssetMesh) -> Any:
    return np.zeros((len(mesh.vertices), 2)) if mesh.uv is None else mesh.uv
