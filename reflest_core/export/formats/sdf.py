# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""SDFormat: a static model for gz-sim, with a visual of the PBR metal workflow for each material.

gz-sim's materials have base colour, roughness and metalness and a fixed F0 of 0.04, so ``rho_s``
does not survive. ``roughness`` is the square root of the GGX width.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

from reflest_core.export.asset import Asset, AssetMaterial
from reflest_core.export.formats.mesh_library import texture_picture
from reflest_core.export.formats.obj import obj_lines, png_bytes
from reflest_core.export.microfacet_material import MicrofacetMaterial

SDF_VERSION = "1.9"


def sdf(asset: Asset, file_name: str) -> dict[str, bytes]:
    """The ``.sdf`` file, a mesh for each material, the texture, and ``model.config``.

    Args:
        asset: What to write. z stays up.
        file_name: Of the file, with its suffix.
    """
    texture = f"{asset.name}_base_colour.png" if asset.base_colour is not None else ""
    root = ElementTree.Element("sdf", version=SDF_VERSION)
    model = ElementTree.SubElement(root, "model", name=asset.name)
    ElementTree.SubElement(model, "static").text = "true"
    if asset.is_far:
        place = " ".join(f"{value:.6f}" for value in asset.origin)
        ElementTree.SubElement(model, "pose").text = f"{place} 0 0 0"
    link = ElementTree.SubElement(model, "link", name="link")
    meshes: dict[str, bytes] = {}
    for index, material in enumerate(asset.materials):
        mesh = asset.mesh.part(index)
        if not len(mesh.faces):
            continue
        uri = f"{material.name}.obj"
        meshes[uri] = ("\n".join([f"o {material.name}", *obj_lines(mesh)]) + "\n").encode()
        for kind in ("collision", "visual"):
            element = ElementTree.SubElement(link, kind, name=f"{material.name}_{kind}")
            geometry = ElementTree.SubElement(element, "geometry")
            shape = ElementTree.SubElement(geometry, "mesh")
            ElementTree.SubElement(shape, "uri").text = uri
            if kind == "visual":
                _add_material(element, material, texture)
    ElementTree.indent(root)
    files = {file_name: _xml(root), "model.config": _config(asset, file_name), **meshes}
    return files | ({texture: png_bytes(texture_picture(asset))} if texture else {})


def _add_material(visual: ElementTree.Element, material: AssetMaterial, texture: str) -> None:
    microfacet = MicrofacetMaterial.from_ward(material.ward)
    facts = "; ".join(f"{name} = {value}" for name, value in material.facts.items())
    # A comment must not hold two hyphens in a row.
    visual.append(ElementTree.Comment(f" reflest: {facts} ".replace("--", "- -")))
    element = ElementTree.SubElement(visual, "material")
    colour = (1.0, 1.0, 1.0) if texture else microfacet.base_colour
    for name in ("ambient", "diffuse"):
        ElementTree.SubElement(element, name).text = " ".join(f"{c:.6f}" for c in (*colour, 1.0))
    specular = " ".join(f"{c:.6f}" for c in (*(microfacet.f0,) * 3, 1.0))
    ElementTree.SubElement(element, "specular").text = specular
    # The scanned side alone is known, but open surfaces should be seen from behind.
    ElementTree.SubElement(element, "double_sided").text = "true"
    metal = ElementTree.SubElement(ElementTree.SubElement(element, "pbr"), "metal")
    if texture:
        ElementTree.SubElement(metal, "albedo_map").text = texture
    ElementTree.SubElement(metal, "roughness").text = f"{microfacet.roughness:.6f}"
    ElementTree.SubElement(metal, "metalness").text = "0"


def _config(asset: Asset, file_name: str) -> bytes:
    root = ElementTree.Element("model")
    ElementTree.SubElement(root, "name").text = asset.name
    ElementTree.SubElement(root, "version").text = "1.0"
    ElementTree.SubElement(root, "sdf", version=SDF_VERSION).text = file_name
    ElementTree.SubElement(root, "description").text = "A surface scanned by reflest."
    ElementTree.indent(root)
    return _xml(root)


def _xml(root: ElementTree.Element) -> bytes:
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"
