# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""OBJ and MTL: a group for each material, with the PBR keywords that Blender and others read.

OBJ has no unit and no up: the file is in metres, z up. ``Pr`` is the square root of the GGX width,
``Pm`` 0; ``Ns`` and ``Ks`` are for readers without them (Blinn-Phong).
"""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from reflest_core.export.asset import Asset, AssetMaterial, AssetMesh
from reflest_core.export.formats.mesh_library import texture_picture
from reflest_core.export.microfacet_material import MicrofacetMaterial


def obj(asset: Asset, file_name: str) -> dict[str, bytes]:
    """The ``.obj`` file, its ``.mtl`` and its texture.

    Args:
        asset: What to write.
        file_name: Of the file, with its suffix.
    """
    stem = file_name.rsplit(".", 1)[0]
    texture = f"{stem}_base_colour.png" if asset.base_colour is not None else ""
    groups = {
        material.name: asset.mesh.part(index) for index, material in enumerate(asset.materials)
    }
    lines = ["# reflest, metres, z up", f"mtllib {stem}.mtl"]
    first = 1
    for name, mesh in groups.items():
        if len(mesh.faces):
            lines += [f"o {name}", f"usemtl {name}", *obj_lines(mesh, first, asset.origin)]
            first += len(mesh.vertices)
    materials = [line for material in asset.materials for line in _material(material, texture)]
    files = {
        file_name: ("\n".join(lines) + "\n").encode(),
        f"{stem}.mtl": ("\n".join(materials) + "\n").encode(),
    }
    return files | ({texture: png_bytes(texture_picture(asset))} if texture else {})


def obj_lines(
    mesh: AssetMesh, first: int = 1, origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> list[str]:
    """Vertices, normals, texture coordinates and faces of a mesh.

    Args:
        mesh: The mesh.
        first: Number of its first vertex in the file.
        origin: Added to the vertices.
    """
    vertices = mesh.vertices.astype(np.float64) + origin
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in vertices.tolist()]
    lines += [f"vn {x:.5f} {y:.5f} {z:.5f}" for x, y, z in mesh.normals.tolist()]
    if mesh.uv is not None:
        lines += [f"vt {u:.6f} {v:.6f}" for u, v in mesh.uv.tolist()]
    pattern = "{0}//{0}" if mesh.uv is None else "{0}/{0}/{0}"
    for face in (mesh.faces + first).tolist():
        lines.append("f " + " ".join(pattern.format(vertex) for vertex in face))
    return lines


def png_bytes(picture: Any) -> bytes:
    """A ``PIL.Image`` as a PNG file's content.

    Args:
        picture: of PIL.
    """
    content = io.BytesIO()
    picture.save(content, "PNG")
    return content.getvalue()


def _material(material: AssetMaterial, texture: str) -> list[str]:
    microfacet = MicrofacetMaterial.from_ward(material.ward)
    width = microfacet.roughness**2
    facts = "; ".join(f"{name} = {value}" for name, value in material.facts.items())
    return [
        f"# {facts}".replace("\n", " "),
        f"newmtl {material.name}",
        "Kd {:.6f} {:.6f} {:.6f}".format(*((1.0, 1.0, 1.0) if texture else microfacet.base_colour)),
        f"Ks {microfacet.f0:.6f} {microfacet.f0:.6f} {microfacet.f0:.6f}",
        f"Ns {min(max(2 / width**2 - 2, 0.0), 1000.0):.3f}",
        f"Pr {microfacet.roughness:.6f}",
        "Pm 0",
        "illum 2",
        *([f"map_Kd {texture}"] if texture else []),
    ]
