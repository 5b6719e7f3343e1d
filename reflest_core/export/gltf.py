# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""glTF 2.0: a sphere of the material, as one JSON file or one binary file.

The base is a dielectric of the metallic-roughness model. ``KHR_materials_specular`` makes its
Fresnel term the constant ``rho_s``, as Ward has it: ``specularFactor`` is the reflectance at the
horizon (F90), and a ``specularColorFactor`` that undoes the default F0 of 0.04 makes F0 the same.
A viewer without the extension shows the colour, the roughness and a highlight of F0 = 0.04.
"""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

from reflest_core.export.material_source import MaterialSource
from reflest_core.export.microfacet_material import MicrofacetMaterial
from reflest_core.export.sphere_mesh import RADIUS, sphere_mesh

DEFAULT_F0 = 0.04
"""Of glTF's dielectric, whose index of refraction is 1.5."""

FLOAT, UNSIGNED_SHORT = 5126, 5123
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
TRIANGLES = 4


def gltf_json(source: MaterialSource) -> bytes:
    """The ``.gltf`` file, its buffer as a data URI."""
    document, binary = _document(source)
    encoded = base64.b64encode(binary).decode("ascii")
    document["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{encoded}"
    return (json.dumps(document, indent=2, allow_nan=False) + "\n").encode("utf-8")


def gltf_binary(source: MaterialSource) -> bytes:
    """The ``.glb`` file: a header and two chunks, each padded to four bytes (glTF 2.0, Sec. 4)."""
    document, binary = _document(source)
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode("utf-8")
    chunks = _chunk(b"JSON", text, b" ") + _chunk(b"BIN\0", binary, b"\0")
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _chunk(kind: bytes, content: bytes, padding: bytes) -> bytes:
    padded = content + padding * (-len(content) % 4)
    return struct.pack("<I4s", len(padded), kind) + padded


def _document(source: MaterialSource) -> tuple[dict[str, Any], bytes]:
    normals, triangles = sphere_mesh()
    vertex_bytes, index_bytes = normals.tobytes(), triangles.tobytes()
    document = {
        "asset": {"version": "2.0", "generator": "reflest"},
        "extensionsUsed": ["KHR_materials_specular"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        # The unit sphere serves as positions and as normals; the node gives it its size.
        "nodes": [{"name": "sphere", "mesh": 0, "scale": [RADIUS] * 3}],
        "meshes": [
            {
                "primitives": [
                    {
                        "attributes": {"POSITION": 0, "NORMAL": 0},
                        "indices": 1,
                        "material": 0,
                        "mode": TRIANGLES,
                    }
                ]
            }
        ],
        "materials": [_material(source)],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": FLOAT,
                "count": len(normals),
                "type": "VEC3",
                "min": normals.min(axis=0).tolist(),
                "max": normals.max(axis=0).tolist(),
            },
            {
                "bufferView": 1,
                "componentType": UNSIGNED_SHORT,
                "count": triangles.size,
                "type": "SCALAR",
            },
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(vertex_bytes), "target": ARRAY_BUFFER},
            {
                "buffer": 0,
                "byteOffset": len(vertex_bytes),
                "byteLength": len(index_bytes),
                "target": ELEMENT_ARRAY_BUFFER,
            },
        ],
        "buffers": [{"byteLength": len(vertex_bytes) + len(index_bytes)}],
    }
    return document, vertex_bytes + index_bytes


def _material(source: MaterialSource) -> dict[str, Any]:
    material = MicrofacetMaterial.from_ward(source.ward)
    return {
        "name": "reflest",
        "pbrMetallicRoughness": {
            "baseColorFactor": [*material.base_colour, 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": material.roughness,
        },
        "extensions": {
            "KHR_materials_specular": {
                "specularFactor": material.f0,
                "specularColorFactor": [1 / DEFAULT_F0] * 3,
            }
        },
        "extras": {"reflest": source.provenance},
    }
