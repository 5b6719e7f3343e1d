# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""glTF 2.0: one mesh with a primitive for each material, as JSON or as one binary file.

The base is a dielectric of the metallic-roughness model. ``KHR_materials_specular`` makes its
Fresnel term the constant ``rho_s``, as in Ward's model: ``specularFactor`` is the reflectance at
the horizon (F90), and a ``specularColorFactor`` of 25 undoes the default F0 of 0.04, so that F0 is
the same. A viewer without the extension shows the colour, the roughness and a highlight of
F0 = 0.04. ``roughnessFactor`` is the square root of the GGX width.

glTF itself has no environment light. It lies beside the file, as Radiance ``.hdr``, which three.js,
model-viewer and Babylon.js take as it is; the scene's ``extras`` name it. Its rows and columns are
theirs: the upper row is glTF's +y, the middle +x, left of it -z.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from reflest_core.export.asset import Asset
from reflest_core.export.environment_file import environment_bytes
from reflest_core.export.formats.mesh_library import trimesh_parts
from reflest_core.export.libraries import library
from reflest_core.export.microfacet_material import MicrofacetMaterial

ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
DEFAULT_F0 = 0.04
"""Of glTF's dielectric, whose index of refraction is 1.5."""
Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1.0]])
"""From z up to glTF's y up: x stays, y becomes -z."""


def glb(asset: Asset, file_name: str) -> dict[str, bytes]:
    """The binary file, and its environment.

    Args:
        asset: What to write.
        file_name: Of the file, with its suffix.
    """
    exchange = library("trimesh.exchange.gltf")
    light = _environment(asset, file_name)
    content = exchange.export_glb(
        _scene(asset), include_normals=True, tree_postprocessor=_completed(asset, light)
    )
    return {file_name: content, **light}


def gltf(asset: Asset, file_name: str) -> dict[str, bytes]:
    """The JSON file, with its buffers as data URIs, and its environment.

    Args:
        asset: What to write.
        file_name: Of the file, with its suffix.
    """
    exchange = library("trimesh.exchange.gltf")
    files = exchange.export_gltf(_scene(asset), include_normals=True, embed_buffers=True)
    tree = json.loads(files["model.gltf"])
    light = _environment(asset, file_name)
    _completed(asset, light)(tree)
    return {file_name: (json.dumps(tree, indent=1, allow_nan=False) + "\n").encode(), **light}


def _environment(asset: Asset, file_name: str) -> dict[str, bytes]:
    if asset.light is None or asset.light_file:
        return {}
    name = f"{file_name.rsplit('.', 1)[0]}_environment.hdr"
    return {name: environment_bytes(asset.light, "hdr")}


def _scene(asset: Asset) -> Any:
    """The parts; the texture goes with the first, for trimesh encodes it for each that has it."""
    trimesh = library("trimesh")
    scene = trimesh.Scene()
    for number, (name, part) in enumerate(trimesh_parts(asset).items()):
        part.apply_transform(Y_UP)
        part.vertex_attributes = {
            f"_{key.upper()}": values for key, values in part.vertex_attributes.items()
        }
        if asset.base_colour is None:
            part.visual.uv = None
        elif number:
            part.visual.material.baseColorTexture = None
        scene.add_geometry(part, node_name=name, geom_name=name)
    return scene


def _completed(asset: Asset, light: Iterable[str]) -> Callable[[dict[str, Any]], None]:
    """What trimesh does not write: one mesh, the extension, extras and names."""
    by_name = {material.name: material for material in asset.materials}
    environment = asset.light_file or next(iter(light), "")

    def complete(tree: dict[str, Any]) -> None:
        _set_targets(tree)
        for written in tree["materials"]:
            material = by_name[written["name"]]
            microfacet = MicrofacetMaterial.from_ward(material.ward)
            if asset.base_colour is None:
                # trimesh has eight bits for it.
                factor = [*microfacet.base_colour, 1.0]
                written["pbrMetallicRoughness"]["baseColorFactor"] = factor
            else:
                written["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
            written["extensions"] = {
                "KHR_materials_specular": {
                    "specularFactor": microfacet.f0,
                    "specularColorFactor": [1 / DEFAULT_F0] * 3,
                }
            }
            written["extras"] = {"reflest": material.facts}
            # The scanned side alone is known, but open surfaces should be seen from behind.
            written["doubleSided"] = not asset.is_swatch
        tree["extensionsUsed"] = sorted({*tree.get("extensionsUsed", []), "KHR_materials_specular"})
        primitives = [one for mesh in tree["meshes"] for one in mesh["primitives"]]
        tree["meshes"] = [{"name": asset.name, "primitives": primitives}]
        node: dict[str, Any] = {"name": asset.name, "mesh": 0}
        if asset.is_far:
            node["translation"] = (Y_UP[:3, :3] @ asset.origin).tolist()
        tree["nodes"] = [node]
        tree["scenes"] = [{"name": asset.name, "nodes": [0]}]
        tree["scene"] = 0
        tree.pop("cameras", None)
        tree["asset"]["generator"] = "reflest"
        if environment:
            tree["scenes"][0]["extras"] = {"reflest": {"environment": environment}}

    return complete


def _set_targets(tree: dict[str, Any]) -> None:
    """Mark buffer views of vertices and of indices, as the validator recommends."""
    for primitive in (one for mesh in tree["meshes"] for one in mesh["primitives"]):
        targets = {accessor: ARRAY_BUFFER for accessor in primitive["attributes"].values()}
        targets[primitive["indices"]] = ELEMENT_ARRAY_BUFFER
        for accessor, target in targets.items():
            tree["bufferViews"][tree["accessors"][accessor]["bufferView"]]["target"] = target
